#pragma once

#include <optional>
#include <set>
#include <unordered_map>
#include <vector>

#include <busbar/client/type_cache.hpp>

#include "dictionary_types.hpp"

namespace busbar::client {

/// The state of a TypeCache, shared with its operations.
struct TypeCache::State {
    State(Requester& r, const TypeCacheLimits& l, DictionaryParser p);

    void begin();
    /// Forgets everything if the namespace table has changed.
    void check_revision();
    void add(binary::DataTypeEntry entry);
    /// Gives the type the encoding id of this value, if the value can be decoded as the type then.
    [[nodiscard]] bool take_encoding(const NodeId& type, const ExtensionObject& value);
    /// Returns the types of all entries.
    [[nodiscard]] std::shared_ptr<const binary::DynamicTypes> compiled();
    /// Returns how many more types may be taken from the server.
    [[nodiscard]] std::size_t room() const
    {
        const std::size_t taken = entries.size() - built_in;
        return taken < limits.max_types ? limits.max_types - taken : 0;
    }

    Requester& requester;
    TypeCacheLimits limits;
    DictionaryParser parser;
    std::uint64_t revision{0};
    /// Entries by the NodeId of the DataType; those of namespace 0 that the build has are present
    /// from the start.
    std::unordered_map<NodeId, binary::DataTypeEntry> entries;
    std::size_t built_in{0};
    /// Empty until the server's dictionaries were read.
    std::optional<detail::DictionaryTypes> dictionaries;
    std::vector<binary::DefinitionError> dictionary_errors;
    /// Types that must still be searched in dictionaries.
    std::set<NodeId> undescribed;
    /// Encodings without a DataType.
    std::set<NodeId> unknown_encodings;
    /// Those whose Variables were asked for their DataType.
    std::set<NodeId> traced_encodings;
    std::shared_ptr<const binary::DynamicTypes> types{
        std::make_shared<const binary::DynamicTypes>()};
    bool is_compiled{false};
};

namespace detail {

/// Returns the first structure that is not null, of a scalar or an array; null if there is none.
[[nodiscard]] const ExtensionObject* first_structure(const Variant& value);

/// Finds the encodings of structures in values.
class EncodingSearch {
public:
    EncodingSearch(const binary::DynamicTypes& types, std::size_t max_structures)
        : types_{types}, left_{max_structures}
    {
    }

    void look_at(const Variant& value);
    /// Returns those that are not among the types.
    [[nodiscard]] std::set<NodeId> take_unknown() { return std::move(unknown_); }

private:
    void look_at(const ExtensionObject& object);
    void look_at(const binary::DynamicValue& value);

    static constexpr std::size_t max_depth = 100;

    const binary::DynamicTypes& types_;
    std::size_t left_;
    std::size_t depth_{0};
    std::set<NodeId> unknown_;
};

/// True for a concrete structure that has an encoding and no DataTypeDefinition.
[[nodiscard]] bool is_undescribed(const binary::DataTypeEntry& entry);

/// Looks for the definitions of `types`, which the cache has entries of, in the server's type
/// dictionaries, which it reads before the first time. They are then no longer undescribed in the
/// cache, unless an answer is missing, which `done` is told.
Operation learn_from_dictionaries(const std::shared_ptr<TypeCache::State>& cache,
                                  const std::set<NodeId>& types, std::function<void(bool)> done,
                                  const ServiceOptions& options);

} // namespace detail

} // namespace busbar::client
