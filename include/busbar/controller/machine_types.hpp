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

struct MachineTypeOptions {
    /// BuiltIn counts if the AddressSpace has no nodes of PLCopen.
    ElementaryTypes elementary{ElementaryTypes::Plcopen};
    /// Enumerations have DataTypes of their own; else they are Int32.
    bool typed_enumerations{true};
};

/// BuiltIn, enumerations as Int32 (seed 000, 6-2-2). The same for NX102.
[[nodiscard]] BUSBAR_API MachineTypeOptions nj501_types();
[[nodiscard]] BUSBAR_API MachineTypeOptions nx102_types();

struct MachineDataType {
    NodeId data_type;
    /// Of a value or an element; ExtensionObject for structures and unions.
    BuiltInType built_in{BuiltInType::Null};
    /// What ExtensionObjects of a structure or union are marked with, else null.
    NodeId encoding{};
};

/// `plcopen_namespace` counts only where a type of PLCopen is given.
[[nodiscard]] BUSBAR_API MachineDataType data_type_of(ElementaryType type, ElementaryTypes choice,
                                                      std::uint16_t plcopen_namespace);

/// The DataType nodes of a program's structures, unions and enumerations, those only that published
/// variables use. Their NodeIds are "Types/" and the name in the program's namespace, their
/// encodings' that and "/Default Binary"; a variable that a vendor names so cannot be published
/// with them. Fields have the members' names and types, their lengths as limits of what is written.
/// A union is a Union of OPC UA; which member a value has is up to who makes it.
///
/// For the thread that changes the AddressSpace.
class BUSBAR_API MachineTypes {
public:
    /// `namespace_index` is the program's.
    MachineTypes(const model::SpaceReader& space, std::uint16_t namespace_index,
                 const MachineTypeOptions& options);

    /// Adds nodes of what `variables` use and is not there yet; types are told apart by their names
    /// in whatever program. The problem's `where` is "types[3] (Point)". An AddressSpace keeps its
    /// types: those that were added before an error stay, and are known here.
    [[nodiscard]] Configured<void> add(model::AddressSpace& space,
                                       std::span<const PublishedVariable> variables);

    /// Of `type`'s elements, if it is an array. Null ids for a type without a node.
    [[nodiscard]] MachineDataType of(const ResolvedType& type) const;
    /// The encoding that a structure or union has once it has a node, whether or not that is there:
    /// for images that are made before nodes are.
    [[nodiscard]] static NodeId encoding_of(std::uint16_t namespace_index, const DerivedType& type);
    /// The choice that counts: `options` as far as `space` has the nodes. So an image is told of it
    /// before there are nodes of the program.
    [[nodiscard]] static ElementaryTypes elementary_in(const model::SpaceReader& space,
                                                       const MachineTypeOptions& options);
    [[nodiscard]] ElementaryTypes elementary() const { return options_.elementary; }

private:
    [[nodiscard]] bool needs_node(const ResolvedType& type) const;
    [[nodiscard]] MachineDataType future_type(const DerivedType& type) const;
    void collect(const TypeUse& use, const ProgramTypes& program,
                 std::vector<const DerivedType*>& found);
    void forget(std::span<const DerivedType* const> types);
    [[nodiscard]] Result<void> add_node(model::AddressSpace& space, const DerivedType& type,
                                        const ProgramTypes& program) const;
    [[nodiscard]] Result<void> add_structure(model::AddressSpace& space, model::NewNode node,
                                             const DerivedType& type,
                                             const ProgramTypes& program) const;
    [[nodiscard]] StructureField field_of(const Member& member, const ProgramTypes& program) const;

    MachineTypeOptions options_;
    std::uint16_t namespace_index_{0};
    std::uint16_t plcopen_namespace_{0};
    /// By the folded name.
    std::unordered_map<std::string, MachineDataType> known_;
};

} // namespace busbar::controller
