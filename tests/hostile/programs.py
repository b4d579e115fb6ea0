"""Commands as processes of their own."""

MAIN = {
    "beamopt": "from beamopt.cli import main; main()",
    "femcheck": "from femcheck.cli import main; main()",
}
