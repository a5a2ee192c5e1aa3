#pragma once

#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include <busbar/binary/dynamic_types.hpp>

#include "data_type_root.hpp"

namespace busbar::binary::detail {

/// Turns DataTypeEntries into DynamicTypes, in steps for all types each: supertypes, then fields,
/// then the consequences of structures directly within others.
class TypeCompiler {
public:
    TypeCompiler(std::vector<DataTypeEntry> from, const DynamicTypeLimits& limits);

    void run();

    struct Entry {
        DataTypeEntry from;
        std::unique_ptr<DynamicType> type;
        DataTypeRoot root;
        /// Number of fields including those of structures directly within it.
        std::size_t nested_fields{0};
        std::size_t depth{0};
        bool is_measured{false};
        bool is_wrong{false};
    };
    [[nodiscard]] std::vector<Entry>& entries() { return entries_; }
    [[nodiscard]] std::vector<DefinitionError>& errors() { return errors_; }

private:
    static constexpr std::size_t none = SIZE_MAX;

    [[nodiscard]] std::size_t index_of(const NodeId& data_type) const;
    [[nodiscard]] NodeId base_of(const DataTypeEntry& from) const;
    void refuse(Entry& entry, StatusCode status, std::string_view field, std::string reason);

    void make_types(std::vector<DataTypeEntry> from);
    void resolve_root(Entry& entry);
    void cut_endless_supertypes();
    void define(Entry& entry);
    void define_structure(Entry& entry, const StructureDefinition& definition);
    void define_option_set(Entry& entry);
    void define_values(Entry& entry, const EnumDefinition& definition);
    [[nodiscard]] bool check_names(Entry& entry, const std::vector<std::string_view>& names);
    void define_field(Entry& entry, const StructureField& from, StructureDefinitionType type);
    [[nodiscard]] bool resolve_field(Entry& entry, const StructureField& from, DynamicField& field);
    void resolve_rank(Entry& entry, const StructureField& from, DynamicField& field);

    void refuse_users_of_wrong_types();
    void measure_all();
    void measure(Entry& entry);
    void refuse_cycle(Entry& entry);

    DynamicTypeLimits limits_;
    std::vector<Entry> entries_;
    std::unordered_map<NodeId, std::size_t> index_;
    std::vector<DefinitionError> errors_;
};

/// True if the field's values cannot be interpreted without its type.
[[nodiscard]] inline bool needs_type(const DynamicField& field)
{
    return field.type != nullptr && (field.is_structure || !field.type->is_structure());
}

/// True if every value of the structure contains one of the field's type.
[[nodiscard]] inline bool is_directly_within(const DynamicType& structure,
                                             const DynamicField& field)
{
    return field.is_structure && field.is_scalar() && !field.is_optional &&
           structure.kind != DynamicType::Kind::Union;
}

} // namespace busbar::binary::detail
