#include <busbar/binary/dynamic_value.hpp>

#include "controller/conversion/shape_node.hpp"
#include "core/visit_built_in.hpp"

namespace busbar::controller::detail {

namespace {

using binary::DynamicArray;
using binary::DynamicValue;

/// Passes the leaves of values on, and counts them.
class Dismantler {
public:
    Dismantler(const binary::DynamicTypes& types, ValueShape::Take take)
        : types_{types}, take_{take}
    {
    }

private:
    // Before leaves(), where clang 14 wants to see what a generic lambda instantiates.
    template <typename T>
    StatusCode each(std::span<const T> values)
    {
        for (const T& value : values) {
            const StatusCode status = take_(next_++, &value);
            if (status.is_bad()) {
                return status;
            }
        }
        return status::Good;
    }

public:
    StatusCode leaves(const ShapeNode& node, const Variant& value)
    {
        if (node.leaf.built_in == BuiltInType::Byte && value.get_if<ByteString>() != nullptr) {
            return bytes(node, *value.get_if<ByteString>());
        }
        if (value.type() != node.leaf.built_in) {
            return status::Bad_TypeMismatch;
        }
        const StatusCode status = check_dimensions(node, value);
        if (status.is_bad()) {
            return status;
        }
        return busbar::detail::visit_built_in(node.leaf.built_in, [&](auto tag) -> StatusCode {
            using T = typename decltype(tag)::type;
            const Array<T>* const array = value.array_if<T>();
            return array != nullptr ? each(array->span()) : take_(next_++, value.get_if<T>());
        });
    }

    StatusCode objects(const ShapeNode& node, const Variant& value)
    {
        if (value.type() != BuiltInType::ExtensionObject) {
            return status::Bad_TypeMismatch;
        }
        StatusCode status = check_dimensions(node, value);
        if (const auto* const scalar = value.get_if<ExtensionObject>();
            status.is_good() && scalar) {
            return object(node, 0, *scalar);
        }
        for (std::size_t i = 0; status.is_good() && i < node.form.elements(); ++i) {
            status = object(node, i, (*value.array_if<ExtensionObject>())[i]);
        }
        return status;
    }

private:
    /// Accepts a ByteString for an array of Byte (Part 4, 5.11.4.2).
    StatusCode bytes(const ShapeNode& node, const ByteString& value)
    {
        if (node.form.rank != 1 || value.size() != node.form.elements()) {
            return status::Bad_WriteNotSupported;
        }
        for (const std::byte byte : value.span()) {
            const auto number = std::to_integer<std::uint8_t>(byte);
            const StatusCode status = take_(next_++, &number);
            if (status.is_bad()) {
                return status;
            }
        }
        return status::Good;
    }

    StatusCode object(const ShapeNode& node, std::size_t element, const ExtensionObject& object)
    {
        const auto value = binary::decode_dynamic(object, types_);
        if (!value) {
            return object.encoding_id() == node.type->encoding_id ? value.error()
                                                                  : status::Bad_TypeMismatch;
        }
        return &value->type() == node.type ? fields(node.fields_of(element), *value)
                                           : StatusCode{status::Bad_TypeMismatch};
    }

    StatusCode fields(const ShapeNode::Fields& nodes, const DynamicValue& value)
    {
        StatusCode status = status::Good;
        for (std::size_t i = 0; status.is_good() && i < nodes.size(); ++i) {
            status = field(nodes[i], i, value);
        }
        return status;
    }

    StatusCode field(const ShapeNode& node, std::size_t index, const DynamicValue& value)
    {
        if (node.kind == ShapeNode::Kind::Kept) {
            return status::Good;
        }
        if (node.kind == ShapeNode::Kind::Structure) {
            return structures(node, index, value);
        }
        const Variant* const content = value.value(index);
        return content != nullptr ? leaves(node, *content) : StatusCode{status::Bad_TypeMismatch};
    }

    StatusCode structures(const ShapeNode& node, std::size_t index, const DynamicValue& value)
    {
        if (const DynamicValue* const scalar = value.structure(index); scalar != nullptr) {
            return fields(node.fields_of(0), *scalar);
        }
        const DynamicArray* const array = value.structures(index);
        if (array == nullptr) {
            return status::Bad_TypeMismatch;
        }
        if (array->values.size() != node.form.elements()) {
            return status::Bad_WriteNotSupported;
        }
        StatusCode status = status::Good;
        for (std::size_t i = 0; status.is_good() && i < array->values.size(); ++i) {
            status = fields(node.fields_of(i), array->values[i]);
        }
        return status;
    }

    const binary::DynamicTypes& types_;
    ValueShape::Take take_;
    std::size_t next_{0};
};

} // namespace

StatusCode take_apart(const ShapeNode& root, const binary::DynamicTypes& types,
                      const Variant& value, ValueShape::Take take)
{
    Dismantler dismantler{types, take};
    return root.kind == ShapeNode::Kind::Structure ? dismantler.objects(root, value)
                                                   : dismantler.leaves(root, value);
}

} // namespace busbar::controller::detail
