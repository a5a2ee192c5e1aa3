#include "shape_builder.hpp"

#include <algorithm>

#include <busbar/core/text.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::controller::detail {

namespace {

using Use = Expected<MappedType, ShapeRefusal>;
using model::NodeIndex;

class TypeLook {
public:
    TypeLook(const model::SpaceReader& space, const binary::DynamicTypes& types, const NodeId& id)
        : space_{space}, id_{id}, node_{space.find(id)}, type_{types.find(id)}
    {
    }

    [[nodiscard]] Use use() const
    {
        if (node_ == model::no_node || space_.node_class(node_) != NodeClass::DataType) {
            return refuse(ShapeError::UnknownType, "is not known");
        }
        const BuiltInType built_in = space_.built_in_type_of(node_);
        if (space_.is_abstract(node_) || built_in == BuiltInType::Variant ||
            is_structure_itself()) {
            return refuse(ShapeError::AbstractType, "is abstract");
        }
        if (is_option_set()) {
            return refuse(ShapeError::OptionSet, "is an OptionSet");
        }
        if (space_.is_subtype_of(node_, id::Enumeration)) {
            return enumeration();
        }
        if (space_.is_subtype_of(node_, id::Structure)) {
            return structure();
        }
        // Decimal is an ExtensionObject but not a Structure.
        if (built_in == BuiltInType::Null || built_in == BuiltInType::ExtensionObject) {
            return refuse(ShapeError::OtherType, "is not a subtype of a built-in type");
        }
        return MappedType{{built_in, false}, nullptr};
    }

private:
    [[nodiscard]] Unexpected<ShapeRefusal> refuse(ShapeError error, std::string_view what) const
    {
        std::string text = "DataType " + to_string(id_);
        if (node_ != model::no_node) {
            text += " (" + printable(space_.browse_name(node_).name.view()) + ")";
        }
        text += " ";
        text += what;
        return Unexpected<ShapeRefusal>{ShapeRefusal{error, {}, std::move(text)}};
    }

    [[nodiscard]] bool is_structure_itself() const { return node_ == space_.find(id::Structure); }

    /// Tells whether the type or one of its supertypes has OptionSetValues.
    [[nodiscard]] bool is_option_set() const
    {
        if (type_ != nullptr && type_->kind == binary::DynamicType::Kind::OptionSet) {
            return true;
        }
        for (NodeIndex type = node_; type != model::no_node; type = space_.supertype(type)) {
            if (has_option_set_values(type)) {
                return true;
            }
        }
        return false;
    }

    [[nodiscard]] bool has_option_set_values(NodeIndex type) const
    {
        const NodeIndex has_property = space_.find(id::HasProperty);
        model::ReferenceCursor cursor = space_.references(type);
        while (const auto reference = cursor.next()) {
            if (reference->is_forward && reference->type == has_property &&
                space_.browse_name(reference->target) == QualifiedName{0, "OptionSetValues"}) {
                return true;
            }
        }
        return false;
    }

    [[nodiscard]] Use enumeration() const
    {
        if (space_.supertype(node_) != space_.find(id::Enumeration)) {
            return refuse(ShapeError::EnumerationParent, "is not a direct subtype of Enumeration");
        }
        if (type_ != nullptr && std::any_of(type_->values.begin(), type_->values.end(),
                                            [](const auto& value) { return value.value == -1; })) {
            return refuse(ShapeError::EnumerationMinusOne, "has a value of -1");
        }
        return MappedType{{BuiltInType::Int32, true}, nullptr};
    }

    [[nodiscard]] Use structure() const
    {
        if (type_ == nullptr || !type_->is_structure()) {
            return refuse(ShapeError::UnknownType, "has no DataTypeDefinition that can be used");
        }
        if (type_->kind == binary::DynamicType::Kind::Union) {
            return refuse(ShapeError::Union, "is a Union");
        }
        if (type_->has_optional_fields) {
            return refuse(ShapeError::OptionalFields, "has optional fields");
        }
        if (is_subtyped()) {
            return refuse(ShapeError::SubtypedStructure,
                          "is a supertype or a subtype of another structure");
        }
        return MappedType{{BuiltInType::ExtensionObject, false}, type_};
    }

    /// Tells whether the structure derives from another or has subtypes, which is allowed in
    /// namespace 0 only.
    [[nodiscard]] bool is_subtyped() const
    {
        if (id_.namespace_index() == 0) {
            return false;
        }
        const NodeIndex parent = space_.supertype(node_);
        return (parent != model::no_node && space_.node_id(parent).namespace_index() != 0) ||
               has_subtype();
    }

    [[nodiscard]] bool has_subtype() const
    {
        const NodeIndex has_subtype = space_.find(id::HasSubtype);
        model::ReferenceCursor cursor = space_.references(node_);
        while (const auto reference = cursor.next()) {
            if (reference->is_forward && reference->type == has_subtype) {
                return true;
            }
        }
        return false;
    }

    const model::SpaceReader& space_;
    const NodeId& id_;
    NodeIndex node_;
    const binary::DynamicType* type_;
};

} // namespace

Expected<MappedType, ShapeRefusal>
use_of(const model::SpaceReader& space, const binary::DynamicTypes& types, const NodeId& data_type)
{
    return TypeLook{space, types, data_type}.use();
}

} // namespace busbar::controller::detail
