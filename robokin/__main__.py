"""`python -m robokin`."""

import sys

try:
    from robokin.cli import main
except KeyboardInterrupt:  # before requests to end are heeded
    sys.exit(130)

if __name__ == "__main__":
    main()
