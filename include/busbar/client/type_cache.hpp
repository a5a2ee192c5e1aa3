#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/client/operation.hpp>
#include <busbar/client/type_dictionary.hpp>
#include <busbar/core/api.hpp>

namespace busbar::client {

/// Limits of what is taken from a server, which may describe types without end.
struct TypeCacheLimits {
    /// DataTypes that are kept in addition to those of namespace 0, including those that have no
    /// definition.
    std::size_t max_types{5'000};
    /// Encodings without a DataType on the server that are kept.
    std::size_t max_unknown_encodings{5'000};
    /// Steps from a type to the types of its fields and its supertype; also the number of times
    /// that values are searched again for structures that became readable only by what was learned.
    std::size_t max_steps{50};
    /// Structures that one call of learn_values() looks at.
    std::size_t max_structures{100'000};
    binary::DynamicTypeLimits definitions;
    /// Type dictionaries that are read, and the limits of each.
    std::size_t max_dictionaries{50};
    DictionaryLimits dictionaries;
};

/// The DataTypes of a server as far as they were needed, from their DataTypeDefinition (Part 3,
/// 5.8.3), or for enumerations of older servers from EnumStrings and EnumValues. Those of namespace
/// 0 are known from the start, whatever the server says about them. With a parser, structures of
/// servers before OPC UA 1.04 are found in their type dictionaries. Structures that a server does
/// not describe stay encoded.
///
/// Forgets everything when the ServerInfo's revision changes, as the namespaces may have other
/// indices then. One thread; the Requester must outlive it and its operations.
class BUSBAR_API TypeCache {
public:
    /// `parser` is parse_type_dictionary of busbar::dictionary, or null for a client that works
    /// without type dictionaries.
    explicit TypeCache(Requester& requester, TypeCacheLimits limits = {},
                       DictionaryParser parser = nullptr);
    TypeCache(const TypeCache&) = delete;
    TypeCache& operator=(const TypeCache&) = delete;
    ~TypeCache();

    /// The types that are known now, never null. A snapshot: DynamicValues that were decoded with
    /// it are valid as long as it is held.
    [[nodiscard]] std::shared_ptr<const binary::DynamicTypes> types() const;

    /// The types of dictionaries that cannot be used, and the reasons: the first 1,000 errors.
    /// types()->errors() has the errors of definitions, including those made from dictionaries.
    /// Valid until the next call.
    [[nodiscard]] const std::vector<binary::DefinitionError>& dictionary_errors() const;

    /// Requests unknown DataTypes of the list and everything that they need. `done` is called when
    /// types() has them, or when the server turns out not to describe them.
    Operation learn(const std::vector<NodeId>& data_types, std::function<void()> done,
                    const ServiceOptions& options = {});
    /// Requests the types of all structures in the values, also of those within others.
    Operation learn_values(std::vector<Variant> values, std::function<void()> done,
                           const ServiceOptions& options = {});
    /// Does the same for values of these Variables, of which some may be null; both lists have the
    /// same length. If no node describes the encoding of a structure, which some servers give the
    /// id of the DataType or of nothing at all, it is the Variable's DataType if the value can be
    /// decoded as that.
    Operation learn_values(std::vector<Variant> values, std::vector<NodeId> variables,
                           std::function<void()> done, const ServiceOptions& options = {});

    struct State;

private:
    std::shared_ptr<State> state_;
};

} // namespace busbar::client
