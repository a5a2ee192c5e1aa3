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

/// The reason why a node cannot be mapped (SH-082679, 9.5), by its place. A node in several places
/// can be mapped only if each of them allows it.
enum class NodePlace : std::uint8_t {
    Mappable,
    StandardNode,      // in namespace 0
    NotBelowObjects,   // or also below Types
    BelowServer,       // even if it is also elsewhere
    BelowAliases,      // even if it is also elsewhere
    RequiredNamespace, // another model of the project requires its namespace
    ArgumentsProperty, // the InputArguments or OutputArguments of a Method
    WrongNodeClass,    // neither a Variable nor a Method
};

/// The places of all nodes of an AddressSpace, found in one walk. Keeps no reference.
class BUSBAR_API NodePlaces {
public:
    /// `required` are the URIs that models require. A View only refers to nodes elsewhere. A node
    /// is below another by references of hierarchical types other than HasEventSource and its
    /// subtypes, by which the Server refers to the sources of events.
    NodePlaces(const model::SpaceReader& space, const std::vector<std::string>& required);

    /// `node` must have been in the AddressSpace at construction.
    [[nodiscard]] NodePlace of(model::NodeIndex node) const;
    /// Returns whether a Variable counts as mappable (SH-082679, 2.1): below Objects,
    /// not below Server, Aliases or a Method, in any namespace.
    [[nodiscard]] bool is_counted(model::NodeIndex node) const;
    /// Returns the least number of references from Objects to the node; 0 for a node that is not
    /// below Objects, or is below Server.
    [[nodiscard]] std::uint32_t level(model::NodeIndex node) const;

private:
    struct Entry {
        NodePlace place{NodePlace::NotBelowObjects};
        bool is_counted{false};
        std::uint32_t level{0};
    };

    std::vector<Entry> entries_;
};

/// The inputs of a check besides the mapping.
struct MappingCheckOptions {
    ModelLimits limits{};
    /// URIs that models require, whose nodes cannot be mapped.
    std::vector<std::string> required{};
    /// For ModelCounters::file_size.
    std::uint64_t file_size{0};
    /// An additional check of a label's name; returns nothing for a valid one.
    std::function<std::optional<Problem>(std::string_view)> check_label{};
};

/// The findings of a check.
struct MappingCheck {
    ModelReports reports{};
    ModelCounters counters{};
};

/// Returns the URIs that models of the project require, for MappingCheckOptions::required and
/// NodePlaces.
[[nodiscard]] BUSBAR_API std::vector<std::string> required_uris(const ModelSet& models);

/// Returns the entries of `mapping` that cannot be served with the nodes of `space`, and the
/// numbers of everything, as the [Check] button of the output window does (manual of model mode,
/// 4.2). Takes time in proportion to nodes and mapped parts.
[[nodiscard]] BUSBAR_API MappingCheck check_mapping(const model::SpaceReader& space,
                                                    const Mapping& mapping,
                                                    const MappingCheckOptions& options = {});
/// Checks the mapping of a project likewise.
[[nodiscard]] BUSBAR_API MappingCheck
check_mapping(const ModelSet& models,
              std::function<std::optional<Problem>(std::string_view)> check_label = {});

} // namespace busbar::controller
