"""The best machine with its drive: figures of a spec that are free, and what is made the best of.

    robot.yaml with free figures --task--> job of a study, objective, limits --search--> machines --answer--> the best

The optimiser is SciPy's, outside; the search for a drive is inside, as a study carries it out: in processes, each
machine kept in ``rows.jsonl``. Of few combinations all are sized that could win.

May import: files, spec, results, search, study, output.
"""
