"""colcon builds the tree into seven ament packages with everything that they need at run time."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from importlib.metadata import entry_points, version
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGES = [
    "rthm",
    "rthm_actuator",
    "rthm_analysis",
    "rthm_bringup",
    "rthm_core",
    "rthm_numerical",
    "rthm_plant_sim",
]


def colcon(*arguments: str | Path, cwd: Path) -> str:
    """Run colcon as in a shell with no ROS: only the tree decides what comes out."""
    foreign = ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "COLCON_PREFIX_PATH", "PYTHONPATH")
    environment = {key: value for key, value in os.environ.items() if key not in foreign}
    environment |= {"COLCON_HOME": str(cwd), "COLCON_LOG_PATH": str(cwd / "log")}
    command = [Path(sys.executable).parent / "colcon", *arguments]
    done = subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def checked_in() -> list[Path]:
    """Files of the checkout as git knows them, new ones included."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    return [Path(name) for name in listed.split("\0") if name and (ROOT / name).is_file()]


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Copy of the checkout, under a name with a space."""
    copy: Path = tmp_path_factory.mktemp("a workspace")
    for name in checked_in():
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, copy / name)
    return copy


@pytest.fixture(scope="module")
def built(tree: Path) -> Path:
    """Prefix of each package after `colcon build` in the root of the checkout."""
    colcon("build", "--executor", "sequential", cwd=tree)
    return tree / "install"


def test_colcon_sees_seven_ament_python_packages_and_nothing_else(tree: Path) -> None:
    rows = (row.split("\t") for row in colcon("list", cwd=tree).splitlines())
    assert sorted((name, kind) for name, _, kind in rows) == [(p, "(ros.ament_python)") for p in PACKAGES]


@pytest.mark.parametrize("package", PACKAGES)
def test_a_built_package_is_in_the_ament_index(built: Path, package: str) -> None:
    share = built / package / "share"
    assert (share / "ament_index/resource_index/packages" / package).is_file()
    assert (share / package / "package.xml").is_file()


@pytest.mark.parametrize("package", PACKAGES)
def test_a_built_package_has_every_file_of_its_source(built: Path, package: str) -> None:
    (site,) = (built / package / "lib").glob("python3.*/site-packages")
    source = Path("src", package)
    inside = [name.relative_to(source) for name in checked_in() if name.is_relative_to(source / package)]
    assert [str(name) for name in inside if not (site / name).is_file()] == []


@pytest.mark.parametrize("package", PACKAGES)
def test_a_built_package_has_its_programs(built: Path, package: str) -> None:
    place = "bin" if package == "rthm_bringup" else f"lib/{package}"
    scripts = [e.name for e in entry_points(group="console_scripts") if e.value.startswith(f"{package}.")]
    assert [name for name in scripts if not os.access(built / package / place / name, os.X_OK)] == []


def test_a_built_workspace_has_the_recorder_where_launch_looks_for_programs(built: Path) -> None:
    assert os.access(built / "rthm_bringup/lib/rthm_bringup/recorder", os.X_OK)


@pytest.mark.parametrize("folder", ["launch", "config"])
def test_launch_files_and_configuration_are_installed(built: Path, folder: str) -> None:
    names = sorted(p.name for p in checked_in() if p.parent == Path("src/rthm_bringup", folder))
    assert names
    assert sorted(p.name for p in (built / "rthm_bringup/share/rthm_bringup" / folder).iterdir()) == names


def test_rthm_is_on_the_path_of_a_sourced_workspace(built: Path) -> None:
    command = '. "$0/setup.bash" && command -v rthm && "$1" "$(command -v rthm)" --help'
    # Python is named twice: neither colcon's scripts nor a first line `#!` survive a space in its path,
    # which a checkout may have.
    environment = os.environ | {"COLCON_PYTHON_EXECUTABLE": os.path.realpath(sys.executable)}
    done = subprocess.run(
        ["bash", "-c", command, built, sys.executable], env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[0] == str(built / "rthm_bringup/bin/rthm")


def test_all_packages_have_one_version_and_the_change_log_has_it() -> None:
    versions = {version(package) for package in PACKAGES}
    assert len(versions) == 1
    assert f"## {versions.pop()} " in (ROOT / "CHANGELOG.md").read_text()
