# A recipe for Conan 2, of a checkout or a tarball: conan create lib/packaging/conan
# The version is that of CMakeLists.txt. Programs come as packages of their own; this has the layers.
import os
import re

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rmdir


class Busbar(ConanFile):
    name = "busbar"
    description = "OPC UA binary protocol stack: server, client, controller"
    license = "MIT"
    topics = ("opc-ua", "automation", "plc")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {
        "shared": [True, False],
        "fPIC": [True, False],
        "net": [True, False],
        "controller": [True, False],
        "namespace0": ["micro", "embedded", "standard", "full"],
    }
    default_options = {
        "shared": False,
        "fPIC": True,
        "net": True,
        "controller": True,
        "namespace0": "full",
    }
    implements = ["auto_shared_fpic"]

    @property
    def _root(self):
        return os.path.join(self.recipe_folder, "..", "..", "..")

    def set_version(self):
        text = load(self, os.path.join(self._root, "CMakeLists.txt"))
        self.version = re.search(r"project\(busbar VERSION ([0-9.]+)", text).group(1)

    def export_sources(self):
        for pattern in (
            "CMakeLists.txt",
            "LICENSE",
            "README.md",
            "CHANGELOG.md",
            "lib/*",
            "include/*",
            "schemas/*",
            "examples/*",
        ):
            copy(self, pattern, self._root, self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def validate(self):
        check_min_cppstd(self, 20)

    def requirements(self):
        self.requires("openssl/[>=3 <4]")
        # The generator of types needs it as well.
        self.requires("pugixml/[>=1.13 <2]")
        if self.options.net:
            self.requires("asio/[>=1.22 <1.31]", transitive_headers=True)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["BUSBAR_TESTS"] = False
        toolchain.cache_variables["BUSBAR_PROGRAMS"] = False
        toolchain.cache_variables["BUSBAR_UNITY"] = True
        toolchain.cache_variables["BUSBAR_NET"] = bool(self.options.net)
        toolchain.cache_variables["BUSBAR_CONTROLLER"] = bool(self.options.controller)
        toolchain.cache_variables["BUSBAR_NAMESPACE0"] = str(self.options.namespace0)
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        CMake(self).install()
        rmdir(self, os.path.join(self.package_folder, "share", "doc"))

    def package_info(self):
        # find_package(busbar) finds what CMake has installed, with its components.
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs.append(os.path.join("lib", "cmake", "busbar"))
