"""Blocks of code in a page that begin with `// PATH` or `# PATH` are the files there, which tests build.

Usage: quotes_test.py ROOT PAGE
"""
import pathlib
import re
import sys

root, page = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
quotes = re.findall(r"^```\w+\n(?://|#) (\S+)\n(.*?)^```$", page.read_text(), re.DOTALL | re.MULTILINE)
faults = [f"{page} quotes no file"] if not quotes else []
for path, text in quotes:
    if not (root / path).is_file():
        faults.append(f"{page} quotes {path}, which is not there")
    elif (root / path).read_text() != text:
        faults.append(f"{page} does not quote {path} as it is: copy it there")
print("\n".join(faults))
sys.exit(1 if faults else 0)
