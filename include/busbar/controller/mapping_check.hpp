#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/mapping.hpp>
#include <busbar/controller/model_limits.hpp>
#include <busbar/controller/model_report.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/model/space_reader.hpp>

namespace busbar::controller {

class ModelSet;

/// Why a node cannot be mapped (seed 001, 9.5), by where it stands. One that stands in several
/// places can be mapped only if it could be in each.
enum class NodePlace : std::uint8_t {
    Mappable,
    StandardNode,      // in namespace 0
    NotBelowObjects,   // or also below Types
    BelowServer,       // also
    BelowAliases,      // also
    RequiredNamespace, // another model of the project requires its namespace
    ArgumentsProperty, // the InputArguments or OutputArguments of a Method
    WrongNodeClass,    // neither a Variable nor a Method
};

/// Where all nodes of an AddressSpace stand, found in one walk. Keeps a reference to nothing.
class BUSBAR_API NodePlaces {
public:
    /// `required` are the URIs that models require. A View shows nodes that stand elsewhere. A node
    /// is below another by references of hierarchical types other than HasEventSource and its
    /// subtypes, by which the Server refers to the sources of events.
    NodePlaces(const model::SpaceReader& space, const std::vector<std::string>& required);

    /// `node` must be one of the AddressSpace as it was.
    [[nodiscard]] NodePlace of(model::NodeIndex node) const;
    /// Variables that count as mappable (seed 001, 2.1): below Objects, not below Server, Aliases
    /// or a Method, whatever their namespace.
    [[nodiscard]] bool is_counted(model::NodeIndex node) const;
    /// References from Objects to the node at the least; 0 for what is not below Objects, or is
    /// below Server.
    [[nodiscard]] std::uint32_t level(model::NodeIndex node) const;

private:
    struct Entry {
        NodePlace place{NodePlace::NotBelowObjects};
        bool is_counted{false};
        std::uint32_t level{0};
    };

    std::vector<Entry> entries_;
};

/// What a check is done against.
struct MappingCheckOptions {
    ModelLimits limits{};
    /// URIs that models require, whose nodes cannot be mapped.
    std::vector<std::string> required{};
    /// For ModelCounters::file_size.
    std::uint64_t file_size{0};
    /// Additionally checks the name of a label; nothing if it is good.
    std::function<std::optional<Problem>(std::string_view)> check_label{};
};

struct MappingCheck {
    ModelReports reports{};
    ModelCounters counters{};
};

/// The URIs that models of the project require, for MappingCheckOptions::required and NodePlaces.
[[nodiscard]] BUSBAR_API std::vector<std::string> required_uris(const ModelSet& models);

/// Which of `mapping` cannot be served with the nodes of `space`, and how much there is of
/// everything: what the [Check] button of the output window does (seed 001, 4.2). Takes time in
/// proportion to nodes and mapped parts.
[[nodiscard]] BUSBAR_API MappingCheck check_mapping(const model::SpaceReader& space,
                                                    const Mapping& mapping,
                                                    const MappingCheckOptions& options = {});
/// The same of a project.
[[nodiscard]] BUSBAR_API MappingCheck
check_mapping(const ModelSet& models,
              std::function<std::optional<Problem>(std::string_view)> check_label = {});

} // namespace busbar::controller
