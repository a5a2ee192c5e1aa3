#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include <busbar/core/function_ref.hpp>
#include <busbar/model/address_space.hpp>

#include "raised_event.hpp"

namespace busbar::server::detail {

/// The properties of a field by all its declarations in event types together.
struct FieldDeclaration {
    bool is_object{false};
    /// An IndexRange may be valid: the field may be an array, a String or a ByteString.
    bool is_divisible{false};
    /// A StatusCode is a value of the field, not the reason why there is none.
    bool is_status{false};
};

/// A declaration of a field with RolePermissions: in events of `owner` and its subtypes, only users
/// who may read the node get the field.
struct FieldGuard {
    model::NodeIndex owner;
    model::NodeHandle node;
};

/// Finds fields by the InstanceDeclarations of the event types (Part 4, 7.22.3), which it collects
/// once and again after references of one of these types have changed, so that a filter of many
/// unknown fields costs no more than one of few known ones.
class EventFields {
public:
    explicit EventFields(const model::AddressSpace& space) : space_{&space} {}
    EventFields(const EventFields&) = delete;
    EventFields& operator=(const EventFields&) = delete;

    [[nodiscard]] const model::AddressSpace& space() const { return *space_; }
    /// Returns the field that an event of `type` or of a subtype may have; of any type for
    /// BaseEventType. Nothing if none ever has it. `path` is not empty.
    [[nodiscard]] std::optional<FieldDeclaration> find(model::NodeIndex type, FieldPath path);
    /// Finds the declarations of this field with RolePermissions; usually none.
    void find_guards(model::NodeIndex type, FieldPath path, std::vector<FieldGuard>& guards);
    /// Changes whenever find_guards may find others.
    [[nodiscard]] std::uint64_t version();
    /// Number of times that the declarations of all types were collected.
    [[nodiscard]] std::uint64_t rounds() const { return rounds_; }

private:
    struct Declaration {
        model::NodeIndex owner;
        model::NodeIndex node;
    };
    struct TypeWatch final : model::NodeWatch {
        explicit TypeWatch(bool& is_noted) : is_noted_{is_noted} {}
        void node_changed(model::NodeIndex, bool) override { is_noted_ = false; }

    private:
        bool& is_noted_;
    };
    void refresh();
    /// Calls `visit` for each declaration of the field, with the type that has it.
    void
    for_each_declaration(model::NodeIndex type, FieldPath path,
                         FunctionRef<void(model::NodeIndex owner, model::NodeIndex node)> visit);
    void note(model::NodeIndex type);
    [[nodiscard]] bool is_of(model::NodeIndex type, const Declaration& declaration) const;
    /// Returns the member that an object, a variable or a type has itself or inherits.
    [[nodiscard]] model::NodeIndex find_member(model::NodeIndex node,
                                               const QualifiedName& name) const;
    [[nodiscard]] model::NodeIndex find_own_member(model::NodeIndex node,
                                                   const QualifiedName& name) const;
    void add(model::NodeIndex node, FieldDeclaration& field) const;

    const model::AddressSpace* space_;
    bool is_noted_{false};
    std::uint64_t rounds_{0};
    /// One for each event type.
    std::deque<TypeWatch> watches_;
    std::unordered_multimap<std::size_t, Declaration> by_name_;
};

} // namespace busbar::server::detail
