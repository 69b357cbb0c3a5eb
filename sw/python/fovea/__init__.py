"""Start runs of `fovea` and read their results, with the standard library alone.

    import fovea
    sim = fovea.run("paper-pal", {"clocks.ddr": "340MHz"})
    print(sim.stats["frame.remap_time.mean"], sim.stats.unit("frame.remap_time.mean"))
    for row in sim.stalls:
        print(row["cause"], row["cycles"])
"""
from .programs import RunFailed, exec, replay, run
from .results import Figures, Results, ResultsError, read

__all__ = ["Figures", "Results", "ResultsError", "RunFailed", "exec", "read", "replay", "run"]
