"""`python -m robokin`."""

from robokin.cli import main

if __name__ == "__main__":
    main()
