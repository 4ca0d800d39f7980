def written(number):
    """Text of a number."""
    return f"{number}\n"
