"""Write the mesh of a plane lattice of beams as CSV files: square cells of a metre, every bar one element.

Usage: make_lattice.py COLUMNS ROWS FOLDER. Writes nodes.csv and beams.csv; node nR-C lies in row R and column C, and row 0
has no bars along it: it stands on the ground.
"""
import pathlib
import sys


def main():
    columns, rows, folder = int(sys.argv[1]), int(sys.argv[2]), pathlib.Path(sys.argv[3])
    with open(folder / "nodes.csv", "w", encoding="utf-8") as nodes:
        nodes.write("name,x,y\n")
        for row in range(rows + 1):
            for column in range(columns + 1):
                nodes.write(f"n{row}-{column},{column},{row}\n")
    with open(folder / "beams.csv", "w", encoding="utf-8") as beams:
        beams.write("first,second,section,material\n")
        for row in range(1, rows + 1):
            for column in range(columns + 1):
                beams.write(f"n{row - 1}-{column},n{row}-{column},bar,steel\n")
                if column > 0:
                    beams.write(f"n{row}-{column - 1},n{row}-{column},bar,steel\n")


if __name__ == "__main__":
    main()
