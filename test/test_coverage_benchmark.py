"""The coverage of the tests: lines of files add up to those of packages."""

from benchmarks.coverage import by_package, lines_of, rows


def test_lines_of_files_add_up_to_those_of_packages() -> None:
    files = {
        f"src/{package}/{package}/{file}.py": {"summary": {"num_statements": all_, "covered_lines": ran}}
        for package, file, all_, ran in (("a", "one", 30, 30), ("b", "one", 10, 4), ("b", "two", 30, 26))
    }

    packages = by_package(lines_of(files))

    assert packages == {"a": (30, 30), "b": (40, 30)}
    assert rows(packages) == "| a | 30 | 100 % |\n| b | 40 | 75 % |\n"
