"""`python -m houle` is `houle`."""

from houle.cli import main

if __name__ == "__main__":
    main()
