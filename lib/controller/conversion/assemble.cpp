#include <busbar/binary/dynamic_value.hpp>

#include "controller/conversion/shape_node.hpp"
#include "core/visit_built_in.hpp"

namespace busbar::controller::detail {

namespace {

using binary::DynamicArray;
using binary::DynamicValue;

/// Makes the values of leaves and counts them.
class Assembler {
public:
    Assembler(const binary::DynamicTypes& types, ValueShape::Fill fill) : types_{types}, fill_{fill}
    {
    }

private:
    // Before leaves(), where clang 14 wants to see what a generic lambda instantiates.
    template <typename T>
    Result<Variant> scalar(const Variant* previous)
    {
        T value{};
        if (previous != nullptr) {
            value = *previous->get_if<T>();
        }
        const StatusCode status = fill_(next_++, &value);
        if (status.is_bad()) {
            return fail(status);
        }
        return Variant{std::move(value)};
    }

    template <typename T>
    Result<Variant> array(const ShapeNode& node, const Variant* previous)
    {
        Array<T> values;
        if (previous != nullptr) {
            values = *previous->array_if<T>();
        } else {
            values.resize(node.form.elements());
        }
        for (T& value : values) {
            const StatusCode status = fill_(next_++, &value);
            if (status.is_bad()) {
                return fail(status);
            }
        }
        return shaped(node, std::move(values));
    }

public:
    Result<Variant> leaves(const ShapeNode& node, const Variant* previous)
    {
        const bool fits = previous != nullptr && previous->type() == node.leaf.built_in &&
                          check_dimensions(node, *previous).is_good();
        return busbar::detail::visit_built_in(node.leaf.built_in, [&](auto tag) -> Result<Variant> {
            using T = typename decltype(tag)::type;
            if constexpr (std::is_same_v<T, Variant>) {
                return fail(status::Bad_InternalError); // an abstract type has no leaves
            } else {
                return node.form.rank == 0 ? scalar<T>(fits ? previous : nullptr)
                                           : array<T>(node, fits ? previous : nullptr);
            }
        });
    }

    Result<Variant> objects(const ShapeNode& node, const Variant* previous)
    {
        if (node.form.rank == 0) {
            auto made = object(node, 0, previous ? previous->get_if<ExtensionObject>() : nullptr);
            return made ? Result<Variant>{Variant{*std::move(made)}} : fail(made.error());
        }
        const bool fits = previous != nullptr && check_dimensions(node, *previous).is_good();
        const auto* const before = fits ? previous->array_if<ExtensionObject>() : nullptr;
        Array<ExtensionObject> values;
        values.reserve(node.form.elements());
        for (std::size_t i = 0; i < node.form.elements(); ++i) {
            auto made = object(node, i, before != nullptr ? &(*before)[i] : nullptr);
            if (!made) {
                return fail(made.error());
            }
            values.push_back(*std::move(made));
        }
        return shaped(node, std::move(values));
    }

private:
    Result<ExtensionObject> object(const ShapeNode& node, std::size_t element,
                                   const ExtensionObject* previous)
    {
        auto value = before(node, previous);
        const StatusCode status = fields(node.fields_of(element), value);
        return status.is_good() ? binary::to_extension_object(value) : fail(status);
    }

    /// Decodes the structure's previous value; without one all its fields are zero.
    [[nodiscard]] DynamicValue before(const ShapeNode& node, const ExtensionObject* previous) const
    {
        if (previous != nullptr && !previous->is_null()) {
            auto decoded = binary::decode_dynamic(*previous, types_);
            if (decoded && &decoded->type() == node.type) {
                return *std::move(decoded);
            }
        }
        return DynamicValue{*node.type};
    }

    StatusCode fields(const ShapeNode::Fields& nodes, DynamicValue& value)
    {
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const StatusCode status = field(nodes[i], i, value);
            if (status.is_bad()) {
                return status;
            }
        }
        return status::Good;
    }

    StatusCode field(const ShapeNode& node, std::size_t index, DynamicValue& value)
    {
        if (node.kind == ShapeNode::Kind::Kept) {
            return status::Good;
        }
        if (node.kind == ShapeNode::Kind::Structure) {
            return node.form.rank == 0 ? structure(node, index, value)
                                       : structures(node, index, value);
        }
        auto content = leaves(node, value.value(index));
        if (!content) {
            return content.error();
        }
        return status_of(value.set(index, *std::move(content)));
    }

    StatusCode structure(const ShapeNode& node, std::size_t index, DynamicValue& value)
    {
        const DynamicValue* const before = value.structure(index);
        DynamicValue content = before != nullptr ? *before : DynamicValue{*node.type};
        const StatusCode status = fields(node.fields_of(0), content);
        return status.is_good() ? status_of(value.set(index, std::move(content))) : status;
    }

    StatusCode structures(const ShapeNode& node, std::size_t index, DynamicValue& value)
    {
        const DynamicArray* const before = value.structures(index);
        DynamicArray content;
        if (before != nullptr && before->values.size() == node.form.elements()) {
            content = *before;
        } else {
            content.values.reserve(node.form.elements());
            for (std::size_t i = 0; i < node.form.elements(); ++i) {
                content.values.push_back(DynamicValue{*node.type});
            }
        }
        for (std::size_t i = 0; i < content.values.size(); ++i) {
            const StatusCode status = fields(node.fields_of(i), content.values[i]);
            if (status.is_bad()) {
                return status;
            }
        }
        return status_of(value.set(index, std::move(content)));
    }

    static StatusCode status_of(const Result<void>& result)
    {
        return result ? StatusCode{status::Good} : result.error();
    }

    const binary::DynamicTypes& types_;
    ValueShape::Fill fill_;
    std::size_t next_{0};
};

} // namespace

Result<Variant> assemble(const ShapeNode& root, const binary::DynamicTypes& types,
                         const Variant* previous, ValueShape::Fill fill)
{
    Assembler assembler{types, fill};
    return root.kind == ShapeNode::Kind::Structure ? assembler.objects(root, previous)
                                                   : assembler.leaves(root, previous);
}

} // namespace busbar::controller::detail
