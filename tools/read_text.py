"""Reads the text in pictures by realgap and by another program, and prints the character error rate of both.

python3 tools/read_text.py REALGAP FOLDER... -- PROGRAM OPTION...       (needs numpy)

FOLDER is a folder that `realgap sense picture` wrote. PROGRAM is called with its options and the path of a grey .pgm file, which is the part of a
picture that contains text according to views.ron, and must print the text: GNU Ocrad, GOCR, or `tesseract --psm 6` with `stdout` after the path.
Consecutive line breaks and spaces count once, as in realgap.
"""

import pathlib
import re
import subprocess
import sys
import tempfile

import numpy

import shrink_png

VIEW = re.compile(
    r'name: "([^"]+)".*text_region: \(x_px: (\d+), y_px: (\d+), width_px: (\d+), '
    r'height_px: (\d+)\), text: "((?:[^"\\]|\\.)*)"'
)


def tidy(text):
    lines = (" ".join(line.split()) for line in text.splitlines())
    return "\n".join(line for line in lines if line)


def edits(a, b):
    row = list(range(len(b) + 1))
    for i, x in enumerate(a, 1):
        before, row[0] = row[0], i
        for j, y in enumerate(b, 1):
            before, row[j] = row[j], min(row[j] + 1, row[j - 1] + 1, before + (x != y))
    return row[-1]


def error_rate(read, truth):
    read, truth = tidy(read), tidy(truth)
    return edits(read, truth) / max(len(truth), 1)


def views(folder):
    for line in (folder / "views.ron").read_text().splitlines():
        found = VIEW.search(line)
        if found:
            name, *region, text = found.groups()
            yield name, [int(side) for side in region], text.replace("\\n", "\n")


def by_realgap(realgap, picture):
    said = subprocess.run(
        [realgap, "vision", "extract", picture, "--extractor", "text"],
        capture_output=True, text=True, check=True,
    ).stdout
    # The program prints a remark before the text and the error after it.
    lines = [line for line in said.splitlines() if not line.startswith("character error rate")]
    return "\n".join(lines[1:])


def by_program(program, picture, region, folder):
    x, y, width, height = region
    rgb = shrink_png.read(picture).astype(float)
    grey = (rgb @ numpy.array([0.2125, 0.7154, 0.0721])).round().astype(numpy.uint8)
    part = grey[y : y + height, x : x + width]
    path = folder / "part.pgm"
    path.write_bytes(b"P5 %d %d 255\n" % (width, height) + part.tobytes())
    options = [str(path), "stdout"] if "tesseract" in program[0] else [str(path)]
    done = subprocess.run([*program, *options], capture_output=True, check=True)
    return done.stdout.decode("utf-8", "replace")


def main():
    if "--" not in sys.argv[2:]:
        sys.exit(__doc__)
    split = sys.argv.index("--")
    realgap, folders, program = sys.argv[1], sys.argv[2:split], sys.argv[split + 1 :]
    with tempfile.TemporaryDirectory() as temporary:
        for name in folders:
            folder, rates = pathlib.Path(name), []
            for view, region, truth in views(folder):
                picture = folder / f"{view}.png"
                read = [
                    by_realgap(realgap, picture),
                    by_program(program, picture, region, pathlib.Path(temporary)),
                ]
                rates.append([error_rate(text, truth) for text in read])
            if not rates:
                sys.exit(f"{folder}: no view with text")
            own, other = numpy.mean(rates, axis=0)
            print(f"{name}: {len(rates)} pictures, realgap {own:.3f}, {program[0]} {other:.3f}")


main()
