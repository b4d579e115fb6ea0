"""`python -m beamopt`: the command line."""

from beamopt.cli import main

if __name__ == "__main__":
    main()
