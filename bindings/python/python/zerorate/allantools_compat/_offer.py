"""The names of allantools that are not offered."""

NOT_OFFERED = (
    "Dataset",
    "Noise",
    "Plot",
    "calc_hdev_phase",
    "calc_htotdev_freq",
    "calc_mtotdev_phase",
    "edf_mtotdev",
    "gcodev",
    "htotdev",
    "mask",
    "mtie_phase_fast",
    "mtotdev",
    "noise",
    "oadev_realtime",
    "ohdev_realtime",
    "pdev",
    "psd2allan",
    "realtime",
    "tdev_realtime",
    "theo1",
    "tierms",
    "ttotdev",
)
"""Names of allantools that `zerorate.allantools_compat` does not have."""


class NotOffered(AttributeError):
    """A name in `NOT_OFFERED` was accessed."""

    def __init__(self, name: str) -> None:
        super().__init__(f"zerorate.allantools_compat does not offer {name}; take it from allantools")
        self.name = name
