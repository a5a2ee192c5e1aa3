#include "reference_types.hpp"

#include <algorithm>
#include <array>

#include <busbar/types/ids.hpp>

namespace busbar::client::detail {

namespace {

struct Type {
    std::string_view name;
    std::uint32_t id;
};

/// Common types; others are looked up on the server.
constexpr std::array types{
    Type{"References", id::References},
    Type{"HierarchicalReferences", id::HierarchicalReferences},
    Type{"NonHierarchicalReferences", id::NonHierarchicalReferences},
    Type{"HasChild", id::HasChild},
    Type{"Organizes", id::Organizes},
    Type{"Aggregates", id::Aggregates},
    Type{"HasComponent", id::HasComponent},
    Type{"HasOrderedComponent", id::HasOrderedComponent},
    Type{"HasProperty", id::HasProperty},
    Type{"HasSubtype", id::HasSubtype},
    Type{"HasTypeDefinition", id::HasTypeDefinition},
    Type{"HasEncoding", id::HasEncoding},
    Type{"HasModellingRule", id::HasModellingRule},
    Type{"HasEventSource", id::HasEventSource},
    Type{"HasNotifier", id::HasNotifier},
    Type{"GeneratesEvent", id::GeneratesEvent},
    Type{"HasInterface", id::HasInterface},
    Type{"HasAddIn", id::HasAddIn},
};

} // namespace

NodeId standard_reference_type(const QualifiedName& name)
{
    const auto* const found = std::find_if(types.begin(), types.end(), [&](const Type& type) {
        return name.namespace_index == 0 && type.name == name.name.view();
    });
    return found == types.end() ? NodeId{} : NodeId{0, found->id};
}

QualifiedName standard_name(const NodeId& reference_type)
{
    const auto* const found = std::find_if(types.begin(), types.end(), [&](const Type& type) {
        return reference_type == NodeId{0, type.id};
    });
    return found == types.end() ? QualifiedName{} : QualifiedName{0, found->name};
}

} // namespace busbar::client::detail
