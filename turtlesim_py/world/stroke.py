"""The pixels of one pen stroke: what `QPainter.drawLine` of Qt 5.15 paints, pixel for pixel.

The original turtlesim draws every step of a turtle as a separate line: on a raster image, without
antialiasing, with square caps and a pen of whole pixels. Qt fills such a line in fixed point, so
ideal geometry misses edge pixels now and then; the rule below misses none. `docs/strokes.md`
explains it step by step, under the names of the functions here. (It is one rule, and so one module,
though it takes more than 300 lines.)

Coordinates are pixels, x to the right and y down; pixel (column, row) has its centre at
(column + 0.5, row + 0.5). Reals are IEEE doubles, and every expression is evaluated as written:
another grouping of the same sum paints other pixels. "26.6" is an int that counts 1/64 px, "16.16"
one that counts 1/65536 px.
"""

from math import floor, inf, isfinite, sqrt

from turtlesim_py.world.floats import fuzzy_equal

Span = tuple[int, int, int]
"""A horizontal run of painted pixels: row, first column, last column (inclusive)."""

Point = tuple[float, float]
"""x, y [px]"""

Segment = tuple[float, float, float, float]
"""x, y of the first point, x, y of the second [px]"""

#: Edge of the image, the original's window [px].
SIZE_PX = 500

_BEYOND = SIZE_PX + 1.0  # [px] lines of one pixel may leave the image so far
_CELL = 1.0 / 64.0  # [px] the grid that Qt snaps outlines to
_FLAT_EDGE = 1e20  # dx/dy of an edge without height; Qt's number
_INT_MIN = -(2**31)


def spans(ax: float, ay: float, bx: float, by: float, width: int) -> list[Span]:
    """List the pixels that a line from a to b paints, each of them once and inside the image.

    Args:
        ax, ay: first argument of drawLine [px]; for a turtle its NEW position. The order matters.
        bx, by: second argument of drawLine [px]; for a turtle its OLD position.
        width: of the pen [px]; 0 and 1 are the same pen.

    Returns:
        No runs at all for coordinates that are not finite.
    """
    try:
        if width <= 1:
            return _thin_stroke(ax, ay, bx, by)
        return _wide_stroke(ax, ay, bx, by, width)
    except (ArithmeticError, ValueError):
        # Beyond 1e40 px a length or a corner may stop being a finite number: Qt paints nothing.
        return []


# --- both widths ---------------------------------------------------------------------------------


def _same_point(ax: float, ay: float, bx: float, by: float) -> bool:
    """Compare as Qt does: at 250 px, points closer than 2.5e-10 px are the same."""
    return fuzzy_equal(ax, bx) and fuzzy_equal(ay, by)


def _to_int(value: float) -> int:
    """Cut towards zero as C++ does on x86-64: whatever 32 bits cannot hold becomes INT_MIN."""
    return int(value) if -2147483649.0 < value < 2147483648.0 else _INT_MIN


# --- width 1: a chain of pixels ------------------------------------------------------------------


def _thin_stroke(ax: float, ay: float, bx: float, by: float) -> list[Span]:
    """Paint one pixel in every column that the line crosses, or in every row if it is steep."""
    if _same_point(ax, ay, bx, by):
        return _thin_dot(ax, ay)
    clipped = _rough_clip(ax, ay, bx, by)
    if clipped is None:
        return []
    x1, y1, x2, y2 = [_to_int(64.0 * c) for c in clipped]
    if abs(x2 - x1) < abs(y2 - y1):
        return _steep_chain(x1, y1, x2, y2)
    if x1 == x2:  # both ends in one cell of 1/64 px, yet not the same point: Qt loses the line
        return []
    return _flat_chain(x1, y1, x2, y2)


def _thin_dot(x: float, y: float) -> list[Span]:
    column, row = _round(x), _round(y)  # rounded, whereas a line takes the pixel that it is in
    if 0 <= column < SIZE_PX and 0 <= row < SIZE_PX:
        return [(row, column, column)]
    return []


def _round(value: float) -> int:
    """Round as Qt 5's qRound: halves up. Below INT_MIN its sum of two ints wraps around to 0."""
    if value >= 0.0:
        return _to_int(value + 0.5)
    below = _to_int(value - 1.0)
    nearest = _to_int(value - below + 0.5) + below
    return nearest if nearest >= _INT_MIN else nearest + 2**32


def _rough_clip(ax: float, ay: float, bx: float, by: float) -> Segment | None:
    """Shorten a line that leaves the image by more than a pixel, so that 26.6 can hold it.

    The order a.x, b.x, a.y, b.y is Qt's; every step sees the points as the last one left them.
    """
    columns_fit = -1.0 <= ax <= _BEYOND and -1.0 <= bx <= _BEYOND
    if columns_fit and -1.0 <= ay <= _BEYOND and -1.0 <= by <= _BEYOND:
        return ax, ay, bx, by
    if not (isfinite(ax) and isfinite(ay) and isfinite(bx) and isfinite(by)):
        return None
    if (ax < -1.0 and bx <= -1.0) or (ax > _BEYOND and bx >= _BEYOND):
        return None
    ax, ay = _pulled_inside(ax, ay, bx, by)
    bx, by = _pulled_inside(bx, by, ax, ay)
    if (ay < -1.0 and by <= -1.0) or (ay > _BEYOND and by >= _BEYOND):
        return None
    ay, ax = _pulled_inside(ay, ax, by, bx)
    by, bx = _pulled_inside(by, bx, ay, ax)
    return ax, ay, bx, by


def _pulled_inside(c: float, n: float, other_c: float, other_n: float) -> Point:
    """Move the point (c, n) along the line to the other one, until c is within [-1, 501]."""
    if c < -1.0:
        bound = -1.0
    elif c > _BEYOND:
        bound = _BEYOND
    else:
        return c, n
    return bound, n + (other_n - n) / (other_c - c) * (bound - c)


def _steep_chain(x1: int, y1: int, x2: int, y2: int) -> list[Span]:
    """Walk a line that is higher than wide: one pixel a row."""
    if y1 > y2:
        x1, y1, x2, y2 = x2, y2, x1, y1
    first, last, x, step = _walk(y1, x1, y2, x2)
    chain = []
    for row in range(first, last + 1):
        column = x >> 16
        if 0 <= column < SIZE_PX:
            chain.append((row, column, column))
        x += step
    return chain


def _flat_chain(x1: int, y1: int, x2: int, y2: int) -> list[Span]:
    """Walk a line at least as wide as high: one pixel a column, joined to runs along each row."""
    if x1 > x2:
        x1, y1, x2, y2 = x2, y2, x1, y1
    first, last, y, step = _walk(x1, y1, x2, y2)
    chain = []
    run_start, row = first, y >> 16
    for column in range(first, last + 1):
        if y >> 16 != row:
            if 0 <= row < SIZE_PX:
                chain.append((row, run_start, column - 1))
            run_start, row = column, y >> 16
        y += step
    if run_start <= last and 0 <= row < SIZE_PX:
        chain.append((row, run_start, last))
    return chain


def _walk(m1: int, n1: int, m2: int, n2: int) -> tuple[int, int, int, int]:
    """Plan a chain: pixel by pixel along the major axis m (m1 < m2), by small steps along n.

    Args:
        m1, n1, m2, n2: both ends [26.6]. Square caps make the chain half a pixel longer at each.

    Returns:
        First and last pixel on m, cut to the image; n at the first of them and its step [16.16].
    """
    rise = (n2 - n1) * 65536
    step = rise // (m2 - m1) if rise >= 0 else -(-rise // (m2 - m1))  # cut towards zero
    first, last = m1 >> 6, m2 >> 6
    bias = 32 if step > 0 else 0  # lopsided, but so is Qt
    n = n1 * 1024 - (step >> 1) + (((64 * first + bias - (m1 - 32)) * step) >> 6)
    if first < 0:
        n -= first * step
        first = 0
    return first, min(last, SIZE_PX - 1), n, step


# --- width 2 and more: a filled rectangle --------------------------------------------------------


def _wide_stroke(ax: float, ay: float, bx: float, by: float, width: int) -> list[Span]:
    """Fill the rectangle along a-b, half a pen's width longer at both ends.

    p-q is the rectangle's midline and changes from step to step, whereas a-b stays. `ratio` is the
    rectangle's width divided by the midline's length.
    """
    is_dot = _same_point(ax, ay, bx, by)
    if is_dot:  # as long as the pen is wide and without caps: a square around the point
        ax, bx, by = ax - width * 0.5, ax + width * 0.5, ay
    dx, dy = bx - ax, by - ay
    length = abs(complex(dx, dy))  # C's hypot; math.hypot and sqrt differ from it in the last bit
    if not 0.0 < length < inf:
        return []
    ratio = width / length

    midline = (ax, ay, bx, by) if is_dot else _with_caps(ax, ay, bx, by, ratio)
    margin_x, margin_y = abs(dy) * ratio * 0.5, abs(dx) * ratio * 0.5
    clipped = _wide_clip(*midline, margin_x, margin_y)
    if clipped is None:
        return []
    px, py, qx, qy = clipped
    length_squared = (qx - px) * (qx - px) + (qy - py) * (qy - py)
    if length_squared == 0.0:
        return []
    ratio *= sqrt((dx * dx + dy * dy) / length_squared)

    if -_CELL < qy - py < _CELL:
        px, py, qx, qy, ratio = _stood_upright(px, py, qx, ratio)
    if -_CELL < qx - px < _CELL:
        return _upright_rectangle(px, py, qx, qy, ratio)
    return _tilted_rectangle(px, py, qx, qy, ratio)


def _with_caps(ax: float, ay: float, bx: float, by: float, ratio: float) -> Segment:
    """Add square caps: both ends move outwards by half the pen's width."""
    k = 0.5 * ratio
    dx, dy = bx - ax, by - ay
    return ax - k * dx, ay - k * dy, bx + k * dx, by + k * dy


def _wide_clip(
    px: float,
    py: float,
    qx: float,
    qy: float,
    margin_x: float,
    margin_y: float,
) -> Segment | None:
    """Cut p-q down to the image with margins around it; None if nothing is left.

    The margins are half of what the pen's width adds in x and y. (Liang and Barsky's algorithm.)
    """
    left, top = 0.0 - margin_x, 0.0 - margin_y
    right = left + ((SIZE_PX + margin_x) - left)
    bottom = top + ((SIZE_PX + margin_y) - top)
    if left <= px <= right and left <= qx <= right and top <= py <= bottom and top <= qy <= bottom:
        return px, py, qx, qy
    dx, dy = qx - px, qy - py
    start, end = 0.0, 1.0
    for origin, d, low, high in ((px, dx, left, right), (py, dy, top, bottom)):
        if d == 0.0:
            if origin <= low or origin >= high:
                return None
            continue
        inverse = 1.0 / d
        enter, leave = (low - origin) * inverse, (high - origin) * inverse
        if enter > leave:
            enter, leave = leave, enter
        start, end = max(start, enter), min(end, leave)
        if start >= end:
            return None
    return px + dx * start, py + dy * start, px + dx * end, py + dy * end


def _stood_upright(
    px: float, py: float, qx: float, ratio: float
) -> tuple[float, float, float, float, float]:
    """Turn a nearly horizontal bar into the vertical bar that covers the same pixels.

    It lies at the height of the FIRST point: a line and its reverse may differ by a row. The ratio
    turns upside down.
    """
    middle = (px + qx) * 0.5
    half = ratio * (abs(qx - px) * 0.5)
    return middle, py - half, middle, py + half, 1.0 / ratio


def _upright_rectangle(px: float, py: float, qx: float, qy: float, ratio: float) -> list[Span]:
    """Fill a nearly vertical bar: the same columns in every row."""
    if py > qy:
        px, py, qy = qx, qy, py
    half = (0.5 * ratio) * (qy - py)
    left, right = _clamp(px - half), _clamp(px + half)
    top, bottom = _clamp(py), _clamp(qy)
    if right - left < _CELL or bottom - top < _CELL:
        return []
    first, last = _first_beyond(left), _last_before(right)
    if first > last:
        return []
    return [(row, first, last) for row in range(_first_beyond(top), _last_before(bottom) + 1)]


def _clamp(value: float) -> float:
    return min(value, float(SIZE_PX)) if value > 0.0 else 0.0  # not-a-number becomes 0


def _first_beyond(edge: float) -> int:
    """Find the first row or column whose centre is beyond the edge."""
    return int(edge + 0.5)


def _last_before(edge: float) -> int:
    """Find the last row or column whose centre is before the edge or on it; -1 if there is none."""
    return floor(edge - 0.5) if edge >= 0.5 else -1


def _tilted_rectangle(px: float, py: float, qx: float, qy: float, ratio: float) -> list[Span]:
    """Snap the four corners to the grid of 1/64 px, always left and up, and fill between them."""
    if py > qy:
        px, py, qx, qy = qx, qy, px, py
    k = 0.5 * ratio
    u, v = (qx - px) * k, (qy - py) * k
    if px < qx:
        tx, ty, lx, ly = px + v, py - u, px - v, py + u
        rx, ry, bx, by = qx + v, qy - u, qx - v, qy + u
    else:
        tx, ty, lx, ly = px - v, py + u, qx - v, qy + u
        rx, ry, bx, by = px + v, py - u, qx + v, qy - u
    top = floor(tx * 64.0) * _CELL, floor(ty * 64.0) * _CELL
    left = floor(lx * 64.0) * _CELL, floor(ly * 64.0) * _CELL
    right = floor(rx * 64.0) * _CELL, floor(ry * 64.0) * _CELL
    bottom = floor(bx * 64.0) * _CELL, floor(by * 64.0) * _CELL
    return _fill(top, left, right, bottom)


def _fill(top: Point, left: Point, right: Point, bottom: Point) -> list[Span]:
    """Go down row by row and fill the pixels from the left side to the right one."""
    first_row = _first_beyond(top[1])
    last_row = _last_before(bottom[1])
    if last_row >= SIZE_PX:
        last_row = SIZE_PX - 1
    start_row = first_row if first_row > 0 else 0
    x1, step1, turn1, below1, step_below1 = _side(top, left, bottom, 0.5, first_row, start_row)
    x2, step2, turn2, below2, step_below2 = _side(top, right, bottom, -0.5, first_row, start_row)
    last_column = SIZE_PX - 1
    rows = []
    for row in range(start_row, last_row + 1):
        if row == turn1:
            x1, step1 = below1, step_below1
        if row == turn2:
            x2, step2 = below2, step_below2
        first, last = x1 >> 16, x2 >> 16
        if first < 0:
            first = 0
        if last > last_column:
            last = last_column
        if first <= last:
            rows.append((row, first, last))
        x1 += step1
        x2 += step2
    return rows


def _side(
    top: Point, corner: Point, bottom: Point, shift: float, first_row: int, start_row: int
) -> tuple[int, int, int, int, int]:
    """Follow one side of a tilted rectangle: the edge down to its corner, and the edge below it.

    Args:
        corner: the left one or the right one.
        shift: turns a crossing [px] into a column: 0.5 on the left side, -0.5 on the right one.
        first_row: the first row of the rectangle, even if above the image; steps count from it.
        start_row: its first row inside the image.

    Returns:
        x at start_row and its step from row to row; the row where the lower edge takes over; x
        there and the step of the lower edge. All x [16.16]: cut, not rounded, and the error of a
        step adds up from row to row.
    """
    (x, y), (corner_x, corner_y), (bottom_x, bottom_y) = top, corner, bottom
    dx, dy = corner_x - x, corner_y - y
    slope = dx / dy if dy else (_FLAT_EDGE if dx > 0.0 else -_FLAT_EDGE)
    dx, dy = bottom_x - corner_x, bottom_y - corner_y
    slope_below = dx / dy if dy else (_FLAT_EDGE if dx > 0.0 else -_FLAT_EDGE)
    step, step_below = int(slope * 65536.0), int(slope_below * 65536.0)

    last_above = _last_before(corner_y)
    start = int((x + shift + ((first_row + 0.5) - y) * slope) * 65536.0)
    below = int((corner_x + shift + ((last_above + 1.5) - corner_y) * slope_below) * 65536.0)
    turn = last_above + 1
    if turn < start_row:
        below += (start_row - turn) * step_below
        turn = start_row
    return start + (start_row - first_row) * step, step, turn, below, step_below
