#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include <busbar/controller/publishing.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/model/address_space.hpp>

/// The DataTypes of the variables that a program publishes.
namespace busbar::controller {

/// The DataTypes that nodes of variables have.
struct MachineTypeOptions {
    /// BuiltIn is used if the AddressSpace has no nodes of PLCopen.
    ElementaryTypes elementary{ElementaryTypes::Plcopen};
    /// Enumerations have their own DataTypes; otherwise they are Int32.
    bool typed_enumerations{true};
};

/// Returns BuiltIn, with enumerations as Int32 (W588, 6-2-2). The same for
/// NX102.
[[nodiscard]] BUSBAR_API MachineTypeOptions nj501_types();
[[nodiscard]] BUSBAR_API MachineTypeOptions nx102_types();

/// The DataType of a variable, and how its values are encoded.
struct MachineDataType {
    NodeId data_type;
    /// The type of a value or an element; ExtensionObject for structures and unions.
    BuiltInType built_in{BuiltInType::Null};
    /// The type id of ExtensionObjects of a structure or union, otherwise null.
    NodeId encoding{};
};

/// `plcopen_namespace` is used only for types of PLCopen.
[[nodiscard]] BUSBAR_API MachineDataType data_type_of(ElementaryType type, ElementaryTypes choice,
                                                      std::uint16_t plcopen_namespace);

/// The DataType nodes of a program's structures, unions and enumerations, only of those that
/// published variables use. Their NodeIds are "Types/" and the name in the program's namespace; the
/// encodings' NodeIds append "/Default Binary". A variable to which a vendor gives such a name
/// cannot be published with them. Fields have the members' names and types, and limit the length of
/// written values to the members' lengths. A union is a Union of OPC UA; the code that creates a
/// value decides which member it has.
///
/// For the thread that changes the AddressSpace.
class BUSBAR_API MachineTypes {
public:
    /// `namespace_index` is the program's.
    MachineTypes(const model::SpaceReader& space, std::uint16_t namespace_index,
                 const MachineTypeOptions& options);

    /// Adds the nodes that `variables` use and that do not exist yet; types are identified by their
    /// names across programs. The problem's `where` is "types[3] (Point)". An AddressSpace keeps
    /// its types: those that were added before an error stay, and are known here.
    [[nodiscard]] Configured<void> add(model::AddressSpace& space,
                                       std::span<const PublishedVariable> variables);

    /// Returns the data type of `type`'s elements, if it is an array. Null ids for a type without a
    /// node.
    [[nodiscard]] MachineDataType of(const ResolvedType& type) const;
    /// Returns the encoding that a structure or union has once it has a node, whether or not that
    /// exists yet: for images that are created before nodes.
    [[nodiscard]] static NodeId encoding_of(std::uint16_t namespace_index, const DerivedType& type);
    /// Returns the effective choice: that of `options` if `space` has the nodes. Lets an image be
    /// created before the program has nodes.
    [[nodiscard]] static ElementaryTypes elementary_in(const model::SpaceReader& space,
                                                       const MachineTypeOptions& options);
    [[nodiscard]] ElementaryTypes elementary() const { return options_.elementary; }

private:
    [[nodiscard]] bool needs_node(const ResolvedType& type) const;
    [[nodiscard]] MachineDataType future_type(const DerivedType& type) const;
    void collect(const ResolvedType& type, const ProgramTypes& program,
                 std::vector<const DerivedType*>& found);
    void forget(std::span<const DerivedType* const> types);
    [[nodiscard]] Result<void> add_node(model::AddressSpace& space, const DerivedType& type,
                                        const ProgramTypes& program) const;
    [[nodiscard]] Result<void> add_structure(model::AddressSpace& space, model::NewNode node,
                                             const DerivedType& type,
                                             const ProgramTypes& program) const;
    [[nodiscard]] StructureField field_of(const std::string& name, const ResolvedType& type) const;

    MachineTypeOptions options_;
    std::uint16_t namespace_index_{0};
    std::uint16_t plcopen_namespace_{0};
    /// Keyed by the folded name.
    std::unordered_map<std::string, MachineDataType> known_;
};

} // namespace busbar::controller
