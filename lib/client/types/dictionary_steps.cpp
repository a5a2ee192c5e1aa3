#include "type_state.hpp"

#include <algorithm>

#include <busbar/client/attributes.hpp>
#include <busbar/client/view.hpp>
#include <busbar/types/ids.hpp>

#include "client/services/handlers.hpp"
#include "type_questions.hpp"

namespace busbar::client::detail {

namespace {

NodeId first_target(const BrowseResult& answer)
{
    const auto found =
        std::ranges::find_if(answer.references, [](const ReferenceDescription& reference) {
            return reference.node_id.is_local();
        });
    return found == answer.references.end() ? NodeId{} : found->node_id.node_id;
}

/// Follows Part 5, 1.04, Annex D: an encoding HasDescription of a Variable whose value is a name in
/// the dictionary that the Variable is a component of.
class DictionarySteps final : public OperationState,
                              public std::enable_shared_from_this<DictionarySteps> {
public:
    DictionarySteps(std::shared_ptr<TypeCache::State> cache, const std::set<NodeId>& types,
                    std::function<void(bool)> done, const ServiceOptions& options)
        : cache_{std::move(cache)}, revision_{cache_->revision}, done_{std::move(done)},
          options_{options}
    {
        for (const NodeId& type : types) {
            asked_.push_back({type, {}, {}});
        }
    }

    void begin() { cache_->dictionaries ? ask_descriptions() : ask_for_dictionaries(); }
    void cancel() override
    {
        done_ = nullptr;
        step_.cancel();
    }
    void no_memory() { finish(true); }

private:
    struct Asked {
        NodeId type;
        NodeId description;
        NodeId dictionary;
    };

    // The dictionaries of the type system "OPC Binary".

    void ask_for_dictionaries()
    {
        step_ = browse(cache_->requester,
                       {references_of(NodeId{0, id::OPCBinarySchema_TypeSystem}, id::HasComponent,
                                      BrowseDirection::Forward)},
                       step_of(shared_from_this(),
                               [](DictionarySteps& self, const std::vector<BrowseResult>& results) {
                                   self.read_dictionaries(results.front());
                               }),
                       browse_limits(), options_);
    }
    void read_dictionaries(const BrowseResult& found)
    {
        if (!may_go_on(is_answer(found.status_code))) {
            return;
        }
        std::vector<ReadValueId> items;
        for (const ReferenceDescription& reference : found.references) {
            // The dictionary of namespace 0 is known, and the longest of all.
            if (reference.node_id.is_local() && reference.node_id.node_id.namespace_index() != 0 &&
                items.size() < cache_->limits.max_dictionaries) {
                dictionaries_.push_back(reference.node_id.node_id);
                items.push_back(attribute_of(reference.node_id.node_id));
            }
        }
        if (items.empty()) {
            return take_dictionaries({});
        }
        step_ = read(cache_->requester, std::move(items),
                     step_of(shared_from_this(),
                             [](DictionarySteps& self, const std::vector<DataValue>& values) {
                                 self.take_dictionaries(values);
                             }),
                     {}, options_);
    }
    void take_dictionaries(const std::vector<DataValue>& values)
    {
        const bool is_complete = std::ranges::all_of(
            values, [](const DataValue& value) { return is_answer(value.status); });
        if (!may_go_on(is_complete)) {
            return;
        }
        DictionaryTypes known{cache_->entries, std::min(cache_->room(), cache_->limits.max_types)};
        std::vector<binary::DefinitionError> errors;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const auto* const xml = values[i].value.get_if<ByteString>();
            auto parsed =
                cache_->parser(xml == nullptr ? std::span<const std::byte>{} : xml->span(),
                               cache_->limits.dictionaries);
            if (parsed) {
                known.add(dictionaries_[i], *std::move(parsed));
            } else {
                errors.push_back({parsed.error().status, dictionaries_[i], "type dictionary", "",
                                  parsed.error().found});
            }
        }
        for (binary::DataTypeEntry& entry : known.entries(errors)) {
            cache_->add(std::move(entry));
        }
        cache_->dictionaries = std::move(known); // kept now that they are complete
        cache_->dictionary_errors = std::move(errors);
        ask_descriptions();
    }

    // Requests the descriptions of the types.

    void ask_descriptions()
    {
        std::vector<BrowseDescription> items;
        for (const Asked& each : asked_) {
            const auto entry = cache_->entries.find(each.type);
            items.push_back(references_of(
                entry == cache_->entries.end() ? each.type : entry->second.encoding_id,
                id::HasDescription, BrowseDirection::Forward));
        }
        ask(std::move(items), &DictionarySteps::take_descriptions);
    }
    void take_descriptions(const std::vector<BrowseResult>& results)
    {
        if (!are_complete(results)) {
            return;
        }
        for (std::size_t i = 0; i < asked_.size(); ++i) {
            asked_[i].description = first_target(results[i]);
        }
        std::erase_if(asked_, [this](const Asked& each) {
            const bool is_nowhere = each.description.is_null();
            cache_->undescribed.erase(is_nowhere ? each.type : NodeId{});
            return is_nowhere;
        });
        if (asked_.empty()) {
            return finish(false);
        }
        std::vector<BrowseDescription> items;
        for (const Asked& each : asked_) {
            items.push_back(
                references_of(each.description, id::HasComponent, BrowseDirection::Inverse));
        }
        ask(std::move(items), &DictionarySteps::take_owners);
    }
    void take_owners(const std::vector<BrowseResult>& results)
    {
        if (!are_complete(results)) {
            return;
        }
        std::vector<ReadValueId> items;
        for (std::size_t i = 0; i < asked_.size(); ++i) {
            asked_[i].dictionary = first_target(results[i]);
            items.push_back(attribute_of(asked_[i].description));
        }
        step_ = read(cache_->requester, std::move(items),
                     step_of(shared_from_this(),
                             [](DictionarySteps& self, const std::vector<DataValue>& values) {
                                 self.take_names(values);
                             }),
                     {}, options_);
    }
    void take_names(const std::vector<DataValue>& values)
    {
        const bool is_complete = std::ranges::all_of(
            values, [](const DataValue& value) { return is_answer(value.status); });
        if (!may_go_on(is_complete)) {
            return;
        }
        for (std::size_t i = 0; i < asked_.size(); ++i) {
            const auto found = cache_->entries.find(asked_[i].type);
            const auto* const name = values[i].value.get_if<String>();
            if (found != cache_->entries.end() && name != nullptr) {
                cache_->is_compiled = false;
                static_cast<void>(cache_->dictionaries->define(
                    found->second, asked_[i].dictionary, name->view(), cache_->dictionary_errors));
            }
            cache_->undescribed.erase(asked_[i].type);
        }
        finish(false);
    }

    void ask(std::vector<BrowseDescription> items,
             void (DictionarySteps::*take)(const std::vector<BrowseResult>&))
    {
        step_ =
            browse(cache_->requester, std::move(items),
                   step_of(shared_from_this(),
                           [take](DictionarySteps& self, const std::vector<BrowseResult>& results) {
                               (self.*take)(results);
                           }),
                   browse_limits(), options_);
    }
    [[nodiscard]] bool are_complete(const std::vector<BrowseResult>& results)
    {
        return may_go_on(std::ranges::all_of(
            results, [](const BrowseResult& result) { return is_answer(result.status_code); }));
    }
    /// Returns false, and ends, if an answer is missing or another server answers now.
    [[nodiscard]] bool may_go_on(bool is_complete)
    {
        cache_->check_revision();
        const bool is_other_server = cache_->revision != revision_;
        if (!is_complete || is_other_server) {
            finish(true);
            return false;
        }
        return true;
    }
    [[nodiscard]] BrowseLimits browse_limits() const
    {
        BrowseLimits limits;
        limits.max_references_per_node = 1'000;
        return limits;
    }
    void finish(bool has_failed)
    {
        if (const auto done = std::exchange(done_, nullptr)) {
            done(has_failed);
        }
    }

    std::shared_ptr<TypeCache::State> cache_;
    std::uint64_t revision_;
    std::function<void(bool)> done_;
    ServiceOptions options_;
    Operation step_;
    std::vector<Asked> asked_;
    std::vector<NodeId> dictionaries_;
};

} // namespace

bool is_undescribed(const binary::DataTypeEntry& entry)
{
    return std::holds_alternative<std::monostate>(entry.definition) && !entry.is_abstract &&
           !entry.encoding_id.is_null();
}

Operation learn_from_dictionaries(const std::shared_ptr<TypeCache::State>& cache,
                                  const std::set<NodeId>& types, std::function<void(bool)> done,
                                  const ServiceOptions& options)
{
    const auto operation =
        std::make_shared<DictionarySteps>(cache, types, std::move(done), options);
    operation->begin();
    return Operation{operation};
}

} // namespace busbar::client::detail
