"""Studies: one sizing per variant of a spec, over fields, catalogues and objectives; stored chunk by chunk.

    study.yaml --schema, axes, plan--> variants --variant, best--> rows --store--> table, maps
                                           local: processes of this machine; cluster: workers of a Dask scheduler

A variant follows from its number alone, so results do not depend on where, when or after how many interruptions it is
computed.

May import: catalog, spec, results, search, sizing, output.
"""

__all__: list[str] = []
