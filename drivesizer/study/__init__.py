"""Studies: one sizing per variant of a spec, over fields, catalogues and objectives; stored chunk by chunk.

    study.yaml --schema, axes, plan--> variants --variant, best--> rows --store--> table, maps
                                           local: processes of this machine; cluster: workers of a Dask scheduler

A variant follows from its number alone, so results do not depend on where, when or after how many interruptions it is
computed.

A variant shares with its spec all data that it leaves as they are: sections of the very same data are the very same
sections, and what hangs on them and a catalogue alone (``Catalog.once``) is made once.

May import: catalog, spec, results, search, sizing, output.
"""
