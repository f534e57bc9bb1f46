"""Parts of a campaign as DuckDB reads them, against `sixaxis campaign summary --json`.

    python query.py SUMMARY.json DIR...

Counts are to be the same, moments within the rounding of sums in another order. The query of docs/campaigns.md is run as it stands there.
"""

import json
import math
import re
import sys
from pathlib import Path

import duckdb

# Sums of some thousand numbers in another order.
ROUNDING = 1e-9

COLUMNS = {"d": "d{}_v", "s": "s{}_per_kg", "I": "i{}_m2", "k": "k_per_s2"}


def column(name):
    """s3/m -> s3_per_kg"""
    head = name.split("/")[0]
    return COLUMNS[head[0]].format(head[1:])


def close(ours, theirs, scale):
    return (ours is None and theirs is None) or abs(ours - theirs) <= ROUNDING * scale


def main():
    summary = json.loads(Path(sys.argv[1]).read_text())
    files = [f"{folder}/*.parquet" for folder in sys.argv[2:]]
    db = duckdb.connect()
    db.execute("create view cases as select * from read_parquet($files)".replace("$files", repr(files)))
    rows, seeds = db.sql("select count(*), count(distinct seed) from cases").fetchall()[0]
    assert rows == seeds == summary["cases"], (rows, seeds, summary["cases"])
    status = dict(db.sql("select status, count(*) from cases group by status").fetchall())
    assert status == summary["status"], (status, summary["status"])
    for parameter in summary["parameters"]:
        ours, name = parameter["four_steps"], column(parameter["name"])
        error = f"four_steps_{name} - true_{name}"
        theirs = db.sql(
            f"""select count({error}), avg({error}), stddev_samp({error}),
                       sqrt(avg(four_steps_se_{name} ** 2)),
                       avg((abs({error}) <= 1.959963984540054 * four_steps_se_{name})::int),
                       avg((abs({error}) <= half_width_95_{name})::int)
                from cases"""
        ).fetchall()[0]
        cases, bias, sd, stated, noise, interval = theirs
        share = lambda key: ours[key] and ours[key]["value"]
        assert cases == ours["cases"], parameter
        assert close(ours["bias"], bias, sd) and close(ours["attained_sd"], sd, sd), (parameter, theirs)
        assert close(ours["stated_sd"], stated, stated or 1), (parameter, theirs)
        assert close(share("within_noise_95"), noise, 1), (parameter, theirs)
        assert close(share("within_stated_95"), interval, 1), (parameter, theirs)
    page = (Path(__file__).parents[4] / "docs" / "campaigns.md").read_text()
    (query,) = re.findall(r"```sql\n(.*?)```", page, re.S)
    shown = db.sql(query.replace("'campaign/*.parquet'", f"read_parquet({files!r})")).fetchall()
    assert shown and all(math.isfinite(x) for x in shown[0] if x is not None), shown
    print(f"{rows} cases: DuckDB agrees; the documented query gives {shown[0]}")


main()
