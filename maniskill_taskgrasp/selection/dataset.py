"""The authors' CSV as arrays: what is read, what is checked, what is dropped and why."""

from __future__ import annotations

import csv
import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from maniskill_taskgrasp.errors import InputError
from maniskill_taskgrasp.knowledge import Affordance
from maniskill_taskgrasp.topology import TOPOLOGY_NAMES

SHA256 = "71af44a9255ce1ef58bd231114b107f1b2b403cf5bc110103cfd409c14b59c3d"
PLATFORM = "platform"
"""16th group of the file, an open-palm support: no topology, so its 67 rows are dropped."""

COLUMNS = (
    *("Object", "A", "B", "C", "GraspedDimension", "Rigidity", "Roundness", "Mass", "Shape"),
    *("Type", "Task", "Force", "Constraint", "Class", "Duration", "OppType", "PIP", "Grasp"),
    *("Grasp_group", "Task_group", *TOPOLOGY_NAMES, PLATFORM),
)
"""The file's 36 columns in its order."""

NUM_TOPOLOGIES = len(TOPOLOGY_NAMES)
FETCH_HINT = "`taskgrasp data fetch` gets the authors' file"


@dataclass(frozen=True, eq=False)
class GraspTable:
    """Rows of the data set, column by column; all arrays have length n (rows) in file order."""

    objects: np.ndarray
    """(n,) str, Object."""
    actions: np.ndarray
    """(n,) str, Task_group: one of 74."""
    phrases: np.ndarray
    """(n,) str, Task: one of 207; fixes action, force, constraint and class."""
    forces: np.ndarray
    constraints: np.ndarray
    classes: np.ndarray
    durations: np.ndarray
    """(n,) [s] Duration: known only after the grasp, so never an input of an honest model."""
    grasps: np.ndarray
    """(n,) str, the observed grasp's own name."""
    topology: np.ndarray
    """(n,) int, index into `TOPOLOGIES`; -1 for platform."""
    label_sets: np.ndarray
    """(n, 15) bool, the file's own multi-label target (`labels.label_sets` explains it)."""
    affordances: dict[str, Affordance]
    """Object name -> its measurements."""

    def __len__(self) -> int:
        return len(self.objects)

    @cached_property
    def pairs(self) -> np.ndarray:
        """(n,) int: number of the row's (object, action) pair, by first appearance."""
        numbers: dict[tuple[str, str], int] = {}
        pairs = zip(self.objects.tolist(), self.actions.tolist(), strict=True)
        return np.array([numbers.setdefault(pair, len(numbers)) for pair in pairs])

    def take(self, rows: np.ndarray) -> GraspTable:
        """The table of some rows, given as indices or as a mask (n,)."""
        columns = {
            name: value[rows]
            for name, value in vars(self).items()
            if name in self.__dataclass_fields__ and isinstance(value, np.ndarray)
        }
        return GraspTable(**columns, affordances=self.affordances)

    def without_platform(self) -> GraspTable:
        """The standard protocol's 6,487 rows: those whose grasp is one of the 15 topologies."""
        return self.take(self.topology >= 0)

    def without_floppy(self) -> GraspTable:
        """The paper's 255-object reading: A = B = C = 0 codes "no fixed shape", not a size."""
        floppy = np.array([self.affordances[name].is_floppy for name in self.objects.tolist()])
        return self.take(~floppy)


def sha256_of(path: Path) -> str:
    """Hexadecimal sha256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def load_table(path: str | Path) -> GraspTable:
    """Read and validate the authors' CSV, all rows.

    A file with another checksum is read too, so that an edited or extended copy can be studied,
    but every cell must make sense.

    Raises:
        InputError: the file is missing, is not this CSV, or a cell is out of range.
    """
    path = Path(path)
    try:
        with path.open(newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file)
            header, rows = tuple(reader.fieldnames or ()), list(reader)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or "not a UTF-8 CSV"
        raise InputError(f"cannot read data set {str(path)!r}: {reason}; {FETCH_HINT}") from None
    if header != COLUMNS:
        wrong = sorted(set(COLUMNS) ^ set(header))[:3] or ["their order"]
        raise InputError(
            f"{path.name!r} is not the grasp data set: its columns differ in "
            f"{', '.join(wrong)}; {FETCH_HINT}"
        )
    if not rows:
        raise InputError(f"{path.name!r} has a header but no rows; {FETCH_HINT}")
    return _to_table(rows, path.name)


def _to_table(rows: list[dict[str, str]], source: str) -> GraspTable:
    for number, row in enumerate(rows, start=2):  # Line 1 is the header.
        _check_row(row, f"{source!r} line {number}")
    index = {name: i for i, name in enumerate(TOPOLOGY_NAMES)} | {PLATFORM: -1}

    def column(name: str) -> np.ndarray:
        return np.array([row[name] for row in rows])

    return GraspTable(
        objects=column("Object"),
        actions=column("Task_group"),
        phrases=column("Task"),
        forces=column("Force"),
        constraints=column("Constraint"),
        classes=column("Class"),
        durations=column("Duration").astype(float),
        grasps=column("Grasp"),
        topology=np.array([index[row["Grasp_group"]] for row in rows]),
        label_sets=np.array([[row[name] == "1" for name in TOPOLOGY_NAMES] for row in rows]),
        affordances=_affordances(rows, source),
    )


def _check_row(row: dict[str, str], where: str) -> None:
    if None in row or any(value is None or not value.strip() for value in row.values()):
        raise InputError(f"{where}: a cell is missing or there is one too many; {FETCH_HINT}")
    for name in ("A", "B", "C", "Mass", "Duration"):
        try:
            value = float(row[name])
        except ValueError:
            value = float("nan")
        if not 0.0 <= value < 1e5:
            raise InputError(f"{where}: {name} is {row[name]!r}, not a number from 0 up")
    if not float(row["A"]) >= float(row["B"]) >= float(row["C"]):
        raise InputError(f"{where}: the extents must be A >= B >= C")
    if row["Grasp_group"] not in (*TOPOLOGY_NAMES, PLATFORM):
        raise InputError(f"{where}: Grasp_group {row['Grasp_group']!r} is no topology")
    if any(row[name] not in ("0", "1") for name in (*TOPOLOGY_NAMES, PLATFORM)):
        raise InputError(f"{where}: the topology columns must hold 0 or 1")


def _affordances(rows: list[dict[str, str]], source: str) -> dict[str, Affordance]:
    """Measurements per object, which must be a function of its name."""
    affordances: dict[str, Affordance] = {}
    for row in rows:
        name = row["Object"]
        affordance = Affordance(
            name=name,
            dimensions_m=(_metres(row["A"]), _metres(row["B"]), _metres(row["C"])),
            mass_kg=round(float(row["Mass"]) / 1000, 6),
            grasped_dimension=row["GraspedDimension"],
            rigidity=row["Rigidity"],
            roundness=row["Roundness"],
            shape=row["Shape"],
            type=row["Type"],
        )
        if affordances.setdefault(name, affordance) != affordance:
            raise InputError(f"{source!r}: object {name!r} is measured in two different ways")
    return dict(sorted(affordances.items()))


def _metres(centimetres: str) -> float:
    return round(float(centimetres) / 100, 5)
