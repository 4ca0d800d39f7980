from toy import scaling


def double(text, factor):
    return f"{scaling.scaled(int(text), factor)}\n"
