"""Studies: one sizing per variant of a spec, over fields, catalogues and objectives; kept as they come.

    study.yaml --schema, axes, plan--> variants --variant, best--> rows --store--> table, maps
                                           local: processes of this machine; cluster: workers of a Dask scheduler

A variant is known by its number alone, so it does not matter where or when it is computed, or after how many
interruptions.

May import: catalog, spec, results, search, sizing, output.
"""

__all__: list[str] = []
