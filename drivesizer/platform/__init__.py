"""A platform on wheels in the plane: how its wheels turn, and what turns them."""

__all__: list[str] = []
