#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/expected.hpp>

#include <busbar/controller/model_limits.hpp>
#include <busbar/controller/model_report.hpp>
#include <busbar/model/nodeset.hpp>

namespace busbar::controller::detail {

struct HeaderModel {
    std::string uri;
    std::string version;
    std::string publication_date;
    /// Follows semantic versioning; empty in older files.
    std::string model_version{};
};

/// Describes a file before its nodes are loaded.
struct ModelHeader {
    HeaderModel model;
    std::vector<HeaderModel> required;
    /// URIs of the namespaces that the file names; nodes need not be in all of them.
    std::vector<std::string> named;
};

/// Reads the header of a file with one namespace; other errors of the file show when it is loaded.
[[nodiscard]] Expected<ModelHeader, ModelReport> read_header(std::string_view text,
                                                             const std::string& name);

/// Reads the text of a source, whose file may have at most so many bytes.
[[nodiscard]] Expected<std::string, ModelReport> read_source(const model::NodeSetSource& source,
                                                             std::uint64_t max_size);

} // namespace busbar::controller::detail
