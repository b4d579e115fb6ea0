"""`python -m femcheck`: the command line."""

from femcheck.cli import main

if __name__ == "__main__":
    main()
