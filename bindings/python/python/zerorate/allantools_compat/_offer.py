"""What is not here."""

NOT_OFFERED = (
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
"""What allantools has and `zerorate.allantools_compat` has not."""


class NotOffered(AttributeError):
    """One of `NOT_OFFERED` was asked for."""

    def __init__(self, name: str) -> None:
        super().__init__(f"zerorate.allantools_compat does not offer {name}; take it from allantools")
        self.name = name
