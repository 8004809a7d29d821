"""The subcommands of ``der``: a new one is one file here.

Each module is named as its command, its docstring is the command's help (the first line stands in
``der --help``), and it has

- ``add_arguments(parser)``: adds the arguments to an ``argparse.ArgumentParser``,
- ``execute(arguments) -> int``: does the work and returns the exit code. It imports
  inside it the modules that take long to load.
"""
