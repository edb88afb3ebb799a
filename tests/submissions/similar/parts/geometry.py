"""Where something is in the window."""

from dataclasses import dataclass

WINDOW = 11.088889


@dataclass
class Spot:
    x: float
    y: float

    @property
    def margin(self):
        horizontally = min(self.x, WINDOW - self.x)
        vertically = min(self.y, WINDOW - self.y)
        return min(horizontally, vertically)

    @property
    def part(self):
        right, upper = self.x * 2 > WINDOW, self.y * 2 > WINDOW
        return ("upper " if upper else "lower ") + ("right" if right else "left")
