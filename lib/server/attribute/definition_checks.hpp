#pragma once

#include <busbar/binary/reader.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/model/data_types.hpp>

namespace busbar::server::detail {

/// Checks the values that clients write against DataTypeDefinitions and the Properties of states.
/// The default accepts all.
class DefinitionChecks {
public:
    DefinitionChecks() = default;
    DefinitionChecks(const DefinitionChecks&) = delete;
    DefinitionChecks& operator=(const DefinitionChecks&) = delete;
    virtual ~DefinitionChecks() = default;

    /// Checks the value of a Variable against its DataType. A structure that is known from its
    /// DataTypeDefinition only has not been decoded yet; even if its type is right, it is refused
    /// if it is not a valid value of that type, or if a text or array in it is longer than its
    /// field allows. Bad_OutOfRange for a value that the enumeration does not have (Part 4,
    /// 5.11.4.4), nor the states of a multi-state item (Part 8, 5.3.3).
    [[nodiscard]] virtual StatusCode check(model::NodeIndex /*variable*/,
                                           model::NodeIndex /*data_type*/, const Variant& /*value*/)
    {
        return {};
    }
    /// Returns whether a value that check() has refused is wrong only in that arrays in fields are
    /// too long.
    [[nodiscard]] virtual bool is_only_too_long(const Variant& /*value*/) { return false; }
    /// A client has set a new value of the Variable in the address space.
    virtual void replaced(model::AddressSpace& /*space*/, model::NodeIndex /*variable*/) {}
};

/// Uses the DataTypes of an address space, which are compiled again when a type was added.
class DataTypeChecks final : public DefinitionChecks {
public:
    /// `space` must outlive this.
    DataTypeChecks(const model::SpaceReader& space, const binary::DecodeLimits& limits)
        : space_{space}, limits_{limits}
    {
    }

    [[nodiscard]] StatusCode check(model::NodeIndex variable, model::NodeIndex data_type,
                                   const Variant& value) override;
    [[nodiscard]] bool is_only_too_long(const Variant& value) override;
    void replaced(model::AddressSpace& space, model::NodeIndex variable) override;

private:
    [[nodiscard]] StatusCode check_structures(const Variant& value);
    [[nodiscard]] StatusCode check_enumeration(model::NodeIndex data_type, const Variant& value);
    [[nodiscard]] const binary::DynamicType* enumeration_of(model::NodeIndex data_type);

    const model::SpaceReader& space_;
    binary::DecodeLimits limits_;
    model::DataTypes data_types_;
};

} // namespace busbar::server::detail
