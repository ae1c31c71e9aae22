"""Build hook: the kernels as machine code, for the system that drivesizer is built on."""

from __future__ import annotations

import shutil
import subprocess
import sys
import sysconfig
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class MachineCode(BuildHookInterface):  # type: ignore[type-arg]
    """Translates the kernels into the package; without them it works too, its closed loops slowly."""

    def dependencies(self) -> list[str]:
        """What translates them: numba, zig where no C compiler links, and what the kernels' rooms load."""
        if sys.version_info >= (3, 15):  # for which there is no numba yet
            return []
        linker = [] if sys.platform == "linux" and shutil.which("cc") else ["ziglang"]
        return ["numba>=0.60", "numpy>=2.0", "pydantic>=2.8", "pyyaml>=6.0.1", "platformdirs>=4.2", *linker]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Make the libraries beside their sources, and the wheel one for this system and every Python."""
        translate = "from drivesizer.files.machine_code import translate_all; translate_all()"
        if subprocess.run([sys.executable, "-c", translate], cwd=self.root, check=False).returncode:  # noqa: S603
            self.app.display_warning("no machine code here: closed loops will run some hundred times slower")
            return
        system = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data |= {"pure_python": False, "tag": f"py3-none-{system}"}
