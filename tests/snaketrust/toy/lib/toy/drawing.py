from toy.texts import written


def draw(number):
    return written(number)
