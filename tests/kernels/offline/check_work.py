#!/usr/bin/env python3
"""Holds the Work that the specs declare against what the kernels execute, as Oclgrind counts it.

Global bytes read and written must agree within 10 % (or 256 bytes: tiny shapes). Integer operations: Oclgrind counts a vector
instruction once and cannot tell address arithmetic from the rest, so declared operations of the
scalar variants (gpu, fpga) may not exceed what was counted by more than 10 %, and float operations
must agree within 10 % there.

Usage: check_work.py OCLGRIND WORK_LAUNCHES
"""
import json
import os
import re
import subprocess
import sys

ELEMENT_BYTES = {"c": 1, "h": 1, "a": 1, "s": 2, "t": 2, "i": 4, "j": 4, "f": 4, "l": 8, "m": 8,
                 "d": 8}
INTEGER = {"add", "sub", "mul", "icmp", "select", "and", "or", "xor", "shl", "lshr", "ashr", "udiv",
           "sdiv", "urem", "srem", "sext", "zext", "trunc"}
FLOAT = {"fadd", "fsub", "fmul", "fdiv", "fcmp", "fneg", "sitofp", "uitofp", "fptosi", "fptoui"}
FLOAT_CALLS = ("fma", "mad", "sqrt", "rsqrt", "exp", "log", "native_", "fabs", "fmin", "fmax")
SLACK = 256
COUNT = re.compile(r"^\s*([\d,]+) - (.+?)(?: \(([\d,]+) bytes\))?$")
VECTOR_CALL = re.compile(r"call _Z\d+v(load|store)(\d+)(.*)")


def number(text):
    return int(text.replace(",", ""))


def vector_bytes(match):
    """Bytes per call of vloadN/vstoreN on global memory, from the mangled name; 0 for others."""
    direction, width, mangled = match.groups()
    if "U3AS1" not in mangled and "U8CLglobal" not in mangled:
        return direction, 0
    if direction == "load":
        element = mangled[-3] if mangled.endswith("()") else mangled[-1]
    else:
        element = re.search(r"Dv\d+_([a-z])", mangled).group(1)
    return direction, int(width) * ELEMENT_BYTES[element]


def counted(lines):
    total = {"read": 0, "written": 0, "int_ops": 0, "float_ops": 0}
    for line in lines:
        match = COUNT.match(line)
        if not match:
            continue
        count, what, size = number(match.group(1)), match.group(2), match.group(3)
        vector = VECTOR_CALL.match(what)
        if what == "load global":
            total["read"] += number(size)
        elif what == "store global":
            total["written"] += number(size)
        elif vector:
            direction, size = vector_bytes(vector)
            total["read" if direction == "load" else "written"] += count * size
        elif what in INTEGER:
            total["int_ops"] += count
        elif what in FLOAT or (what.startswith("call") and any(c in what for c in FLOAT_CALLS)):
            total["float_ops"] += count
        elif what.startswith("call"):
            total["int_ops"] += count
    return total


def off(declared, measured):
    """Relative difference; below SLACK bytes or operations, borders of tiny shapes are no finding."""
    difference = abs(declared - measured)
    return 0 if difference <= SLACK else difference / max(measured, 1)


def complaints(launch, total):
    for key in ("read", "written"):
        if off(launch[key], total[key]) > 0.10:
            yield f"{key} bytes declared {launch[key]}, counted {total[key]}"
    if launch["variant"] != "cpu":
        if launch["int_ops"] > 1.1 * total["int_ops"] + SLACK:
            yield f"integer operations declared {launch['int_ops']}, counted {total['int_ops']}"
        if off(launch["float_ops"], total["float_ops"]) > 0.10 and launch["float_ops"] > 0:
            yield f"float operations declared {launch['float_ops']}, counted {total['float_ops']}"


def main():
    oclgrind, binary = sys.argv[1:3]
    environment = dict(os.environ, OCL_ICD_VENDORS="/nonexistent")
    run = subprocess.run([oclgrind, "--inst-counts", binary], env=environment, text=True,
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    parts = re.split(r"^LAUNCH ", run.stdout, flags=re.M)[1:]
    failed = 0
    for part in parts:
        lines = part.splitlines()
        launch, total = json.loads(lines[0]), counted(lines[1:])
        problems = list(complaints(launch, total))
        failed += bool(problems)
        for problem in problems:
            print(f"{launch['kernel']}.{launch['variant']} ({launch['shape']}): {problem}")
    print(f"{len(parts)} launches, {failed} whose declared Work is off")
    if run.returncode != 0 or not parts or "MISMATCH" in run.stdout:
        print(run.stdout[-2000:])
        return 1
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
