"""Build of rthm_bringup; name, version and description are those of package.xml."""

from glob import glob
from xml.etree import ElementTree

from setuptools import find_packages, setup

manifest = ElementTree.parse("package.xml")
name = manifest.findtext("name")

setup(
    name=name,
    version=manifest.findtext("version"),
    description=manifest.findtext("description"),
    maintainer=manifest.findtext("maintainer"),
    maintainer_email=manifest.find("maintainer").get("email"),
    license=manifest.findtext("license"),
    python_requires=">=3.11",
    package_dir={"": "."},  # an editable install is then one path entry, not an import hook
    packages=find_packages(exclude=["test", "test.*"]),
    package_data={"": ["py.typed", "**/*.yaml", "**/*.html", "**/*.css", "**/*.js", "**/*.csv", "**/*.xml"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{name}"]),
        (f"share/{name}", ["package.xml"]),
        (f"lib/{name}", sorted(glob("programs/*"))),
        (f"share/{name}/launch", sorted(glob("launch/*.launch.py"))),
        (f"share/{name}/config", sorted(glob("config/*.yaml"))),
    ],
    install_requires=["mcap", "rich", "typer"],
    entry_points={"console_scripts": ["rthm = rthm_bringup.cli:main"]},
    zip_safe=True,
)
