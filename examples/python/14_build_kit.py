"""
Build kit
=========

At the end, you have the files to build the starfish: pattern, printed parts, lists and the assembly sheet.
"""

# %%
# `hs.write_kit(robot, folder)` writes it. `hs.build_kit` makes it in memory.
import hydrostat as hs

robot = hs.load_robot("gallery:starfish")
kit = hs.build_kit(robot)
files = sorted(kit.files)
print(len(files), "files, such as", ", ".join(name for name in files if name.startswith("lists/")))

# %%
# Quality checks measure the finished files.
checks = len(kit.checks)
print(checks, "checks:", "passed" if all(check.passed for check in kit.checks) else "failed")

# %%
# The robot of the kit.
figure = hs.draw_rest(robot)
