#include <busbar/binary/dynamic_value.hpp>

#include "body_walk.hpp"
#include "core/visit_built_in.hpp"
#include "object_body.hpp"

namespace busbar::binary {

namespace {

template <typename T>
Variant default_variant(const DynamicField& field)
{
    if (!field.is_scalar()) {
        return Variant{Array<T>{}};
    }
    if constexpr (std::is_same_v<T, Variant>) {
        return {};
    } else {
        return Variant{T{}};
    }
}

DynamicContent default_content(const DynamicField& field)
{
    if (field.is_optional) {
        return {};
    }
    if (!field.is_structure) {
        return busbar::detail::visit_built_in(field.built_in, [&](auto tag) {
            return default_variant<typename decltype(tag)::type>(field);
        });
    }
    if (field.is_scalar()) {
        return DynamicValue{*field.type};
    }
    return DynamicArray{};
}

} // namespace

DynamicValue::DynamicValue(const DynamicType& type) : type_{&type}
{
    if (type.kind == DynamicType::Kind::Union) {
        return;
    }
    contents_.reserve(type.fields.size());
    for (const DynamicField& field : type.fields) {
        contents_.push_back(default_content(field));
    }
}

DynamicValue::DynamicValue(const DynamicType& type, std::vector<DynamicContent> contents,
                           std::uint32_t selected)
    : type_{&type}, contents_{std::move(contents)}, selected_{selected}
{
}

DynamicValue::DynamicValue(const DynamicValue& other) = default;
DynamicValue::DynamicValue(DynamicValue&& other) noexcept = default;
DynamicValue& DynamicValue::operator=(const DynamicValue& other) = default;
DynamicValue& DynamicValue::operator=(DynamicValue&& other) noexcept = default;
DynamicValue::~DynamicValue() = default;

bool operator==(const DynamicValue& a, const DynamicValue& b)
{
    return a.type_ == b.type_ && a.selected_ == b.selected_ && a.contents_ == b.contents_;
}

const DynamicContent* DynamicValue::content(std::size_t field) const
{
    if (type_->kind == DynamicType::Kind::Union) {
        const bool is_selected = selected_ != 0 && field == selected_ - 1U && !contents_.empty();
        return is_selected ? &contents_.front() : nullptr;
    }
    const bool is_there = field < contents_.size() &&
                          !std::holds_alternative<std::monostate>(contents_[field].base());
    return is_there ? &contents_[field] : nullptr;
}

const Variant* DynamicValue::value(std::size_t field) const
{
    const DynamicContent* const found = content(field);
    return found == nullptr ? nullptr : std::get_if<Variant>(&found->base());
}

const DynamicValue* DynamicValue::structure(std::size_t field) const
{
    const DynamicContent* const found = content(field);
    return found == nullptr ? nullptr : std::get_if<DynamicValue>(&found->base());
}

const DynamicArray* DynamicValue::structures(std::size_t field) const
{
    const DynamicContent* const found = content(field);
    return found == nullptr ? nullptr : std::get_if<DynamicArray>(&found->base());
}

Result<void> DynamicValue::set(std::size_t field, Variant content)
{
    if (field >= type_->fields.size()) {
        return busbar::fail(status::Bad_NotFound);
    }
    if (!detail::fits(type_->fields[field], content)) {
        return busbar::fail(status::Bad_TypeMismatch);
    }
    if (auto encoded = detail::encode_objects(content); !encoded) {
        return encoded;
    }
    return replace(field, std::move(content));
}

Result<void> DynamicValue::set(std::size_t field, DynamicValue content)
{
    if (field >= type_->fields.size()) {
        return busbar::fail(status::Bad_NotFound);
    }
    const DynamicField& to = type_->fields[field];
    if (detail::fits(to, content)) {
        return replace(field, std::move(content));
    }
    if (!detail::may_be_subtype(to, content)) {
        return busbar::fail(status::Bad_TypeMismatch);
    }
    auto object = to_extension_object(content);
    return object ? set(field, Variant{std::move(*object)}) : busbar::fail(object.error());
}

Result<void> DynamicValue::set(std::size_t field, DynamicArray content)
{
    if (field >= type_->fields.size()) {
        return busbar::fail(status::Bad_NotFound);
    }
    if (!detail::fits(type_->fields[field], content)) {
        return busbar::fail(status::Bad_TypeMismatch);
    }
    return replace(field, std::move(content));
}

Result<void> DynamicValue::clear(std::size_t field)
{
    if (field >= type_->fields.size()) {
        return busbar::fail(status::Bad_NotFound);
    }
    if (type_->kind == DynamicType::Kind::Union) {
        contents_.clear();
        selected_ = 0;
        return {};
    }
    if (!type_->fields[field].is_optional) {
        return busbar::fail(status::Bad_TypeMismatch);
    }
    contents_[field] = DynamicContent{};
    return {};
}

/// `content` may be a copy of a part of this value, never a reference to it.
Result<void> DynamicValue::replace(std::size_t field, DynamicContent content)
{
    if (type_->kind != DynamicType::Kind::Union) {
        contents_[field] = std::move(content);
        return {};
    }
    contents_.clear();
    contents_.push_back(std::move(content));
    selected_ = static_cast<std::uint32_t>(field) + 1;
    return {};
}

} // namespace busbar::binary
