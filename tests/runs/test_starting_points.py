# SPDX-License-Identifier: LGPL-3.0-or-later
"""Case files that `protractile new` writes."""

from pathlib import Path

import pytest

from protractile.runs.case.reading import load_checked
from protractile.runs.case.starting_points import write_case
from protractile.runs.cautions import rules
from protractile.runs.cautions.context import Context
from protractile.runs.options import Kind, Standard
from protractile.runs.pipeline.combinations import combination_states
from protractile.runs.pipeline.proofs import prove
from protractile.runs.process.bad_input import BadInput


@pytest.mark.parametrize("standard", Standard)
@pytest.mark.parametrize("kind", Kind)
def test_a_new_case_passes_its_proofs_without_cautions(
    here: Path, standard: Standard, kind: Kind
) -> None:
    write_case("new.toml", standard, kind)
    checked = load_checked("new.toml")
    assert len(checked.case.combinations) == {"en13001": 4, "en280": 3}[standard]
    assert rules.cautions(Context(checked.case, checked.boom), rules.OF_INPUTS) == []
    proofs = prove(checked.case, combination_states(checked.case))
    assert proofs.rows
    assert all(abs(row.value) <= row.limit for row in proofs.rows if row.limit is not None)
    with pytest.raises(BadInput) as caught:
        write_case("new.toml", standard, kind)
    assert str(caught.value) == "new.toml: file: exists already; give another name"
