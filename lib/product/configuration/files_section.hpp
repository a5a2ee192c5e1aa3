#pragma once

#include "config.hpp"

namespace busbar::product {

/// [[files]], after [certificates]: no folder of files may have the keys in it.
[[nodiscard]] std::vector<FilesConfig> read_files(const TomlTable& root,
                                                  const CertificateConfig& certificates);

} // namespace busbar::product
