"""``python -m drivesizer``."""

from drivesizer.cli import main

if __name__ == "__main__":
    main()
