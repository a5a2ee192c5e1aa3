#include <busbar/client/type_cache.hpp>

#include <algorithm>
#include <utility>

#include <busbar/client/attributes.hpp>
#include <busbar/client/view.hpp>

#include "client/services/handlers.hpp"
#include "type_questions.hpp"
#include "type_state.hpp"

namespace busbar::client {

namespace {

/// Goes from encodings to their types, from types to those they need, and again to the values,
/// until nothing is new or a limit is reached.
class LearnOperation final : public detail::OperationState,
                             public std::enable_shared_from_this<LearnOperation> {
public:
    LearnOperation(std::shared_ptr<TypeCache::State> cache, std::vector<Variant> values,
                   std::vector<NodeId> variables, std::function<void()> done,
                   const ServiceOptions& options)
        : cache_{std::move(cache)}, values_{std::move(values)},
          variables_{std::move(variables)}, done_{std::move(done)}, options_{options}
    {
    }

    void begin(const std::vector<NodeId>& data_types)
    {
        cache_->check_revision();
        revision_ = cache_->revision;
        want(data_types);
        if (wanted_.empty()) {
            later_ = detail::later(cache_->requester,
                                   detail::step_of(shared_from_this(), [](LearnOperation& self) {
                                       self.is_later_ = false;
                                       self.next_types();
                                   }));
            is_later_ = true;
        } else {
            ask_types();
        }
    }
    void cancel() override
    {
        done_ = nullptr;
        step_.cancel();
        if (is_later_) {
            cache_->requester.cancel(later_);
        }
    }
    /// Forgets incomplete knowledge, so that it is requested again.
    void no_memory()
    {
        if (done_ == nullptr) {
            return;
        }
        for (const NodeId& type : named_) {
            cache_->entries.erase(type);
            cache_->is_compiled = false;
        }
        finish();
    }

private:
    /// Includes what known types need: it may be missing since an answer failed or was not waited
    /// for.
    void want(std::vector<NodeId> types)
    {
        while (!types.empty()) {
            const NodeId type = std::move(types.back());
            types.pop_back();
            if (detail::is_known_to_all(type) || !seen_.insert(type).second) {
                continue;
            }
            const auto known = cache_->entries.find(type);
            if (known != cache_->entries.end()) {
                const auto needed = detail::needed_by(known->second);
                types.insert(types.end(), needed.begin(), needed.end());
                look_up_later(type);
            } else if (wanted_.size() < cache_->room()) {
                wanted_.insert(type);
            }
        }
    }
    void look_up_later(const NodeId& type)
    {
        if (cache_->undescribed.contains(type)) {
            undescribed_.insert(type);
        }
    }
    /// Returns false, and ends, if the question is obsolete or it takes too long.
    [[nodiscard]] bool may_go_on()
    {
        cache_->check_revision();
        const std::uint64_t now = cache_->revision;
        const bool is_other_server = revision_ != 0 && revision_ != now;
        revision_ = now;
        if (is_other_server || ++steps_ > cache_->limits.max_steps) {
            finish();
            return false;
        }
        return true;
    }

    // One step: requests the needed types.

    void ask_types()
    {
        asked_.assign(wanted_.begin(), wanted_.end());
        wanted_.clear();
        std::vector<ReadValueId> items;
        for (const NodeId& type : asked_) {
            detail::ask_attributes(type, items);
        }
        step_ = read(cache_->requester, std::move(items),
                     detail::step_of(shared_from_this(),
                                     [](LearnOperation& self, std::vector<DataValue> values) {
                                         self.attributes_ = std::move(values);
                                         self.ask_references();
                                     }),
                     {}, options_);
    }
    void ask_references()
    {
        std::vector<BrowseDescription> items;
        for (const NodeId& type : asked_) {
            detail::ask_references(type, items);
        }
        step_ = browse(
            cache_->requester, std::move(items),
            detail::step_of(shared_from_this(),
                            [](LearnOperation& self, const std::vector<BrowseResult>& results) {
                                self.take_answers(results);
                            }),
            browse_limits(), options_);
    }
    void take_answers(const std::vector<BrowseResult>& references)
    {
        if (!may_go_on()) {
            return;
        }
        std::vector<ReadValueId> items;
        named_.clear();
        for (std::size_t i = 0; i < asked_.size(); ++i) {
            auto answers =
                detail::read_answers(asked_[i],
                                     std::span{attributes_}.subspan(i * detail::attributes_per_type,
                                                                    detail::attributes_per_type),
                                     std::span{references}.subspan(i * detail::browses_per_type,
                                                                   detail::browses_per_type));
            if (answers.has_failed || cache_->room() == 0) {
                has_failed_ = true;
                continue;
            }
            want(detail::needed_by(answers.entry));
            if (!answers.names.is_null()) {
                items.push_back(attribute_of(std::move(answers.names)));
                named_.push_back(asked_[i]);
            }
            if (cache_->parser != nullptr && detail::is_undescribed(answers.entry)) {
                cache_->undescribed.insert(answers.entry.id);
                look_up_later(answers.entry.id);
            }
            cache_->add(std::move(answers.entry));
        }
        items.empty() ? next_types() : ask_names(std::move(items));
    }
    void ask_names(std::vector<ReadValueId> items)
    {
        step_ =
            read(cache_->requester, std::move(items),
                 detail::step_of(shared_from_this(),
                                 [](LearnOperation& self, const std::vector<DataValue>& values) {
                                     self.take_names(values);
                                 }),
                 {}, options_);
    }
    void take_names(const std::vector<DataValue>& values)
    {
        for (std::size_t i = 0; i < named_.size(); ++i) {
            const auto found = cache_->entries.find(named_[i]);
            auto definition = detail::definition_of(values[i].value);
            if (found != cache_->entries.end() && definition) {
                found->second.definition = *std::move(definition);
                cache_->is_compiled = false;
            }
        }
        named_.clear();
        next_types();
    }
    void next_types()
    {
        if (!wanted_.empty()) {
            return ask_types();
        }
        if (!undescribed_.empty()) {
            return ask_dictionaries();
        }
        look_at_values();
    }
    void ask_dictionaries()
    {
        step_ = detail::learn_from_dictionaries(
            cache_, std::exchange(undescribed_, {}),
            detail::step_of(shared_from_this(),
                            [](LearnOperation& self, bool has_failed) {
                                self.has_failed_ = self.has_failed_ || has_failed;
                                self.look_at_values();
                            }),
            options_);
    }

    // Another step: searches the values for encodings.

    void look_at_values()
    {
        const auto types = cache_->compiled();
        detail::EncodingSearch search{*types, cache_->limits.max_structures};
        for (const Variant& value : values_) {
            search.look_at(value);
        }
        encodings_.clear();
        std::vector<BrowseDescription> items;
        for (const NodeId& encoding : search.take_unknown()) {
            if (cache_->unknown_encodings.contains(encoding)) {
                continue;
            }
            if (!tried_encodings_.insert(encoding).second) {
                // Its type is known now, and cannot be used or has another encoding.
                give_up(encoding);
            } else if (encodings_.size() < cache_->limits.max_types) {
                items.push_back(detail::ask_type_of(encoding));
                encodings_.push_back(encoding);
            }
        }
        if (items.empty()) {
            return traced_.empty() ? ask_variables(*types) : take_traced();
        }
        step_ = browse(
            cache_->requester, std::move(items),
            detail::step_of(shared_from_this(),
                            [](LearnOperation& self, const std::vector<BrowseResult>& results) {
                                self.take_types(results);
                            }),
            browse_limits(), options_);
    }
    void take_types(const std::vector<BrowseResult>& results)
    {
        if (!may_go_on()) {
            return;
        }
        std::vector<NodeId> types;
        for (std::size_t i = 0; i < encodings_.size(); ++i) {
            auto type = detail::type_of(results[i]);
            if (type && !type->is_null()) {
                types.push_back(*std::move(type));
            } else if (type &&
                       cache_->unknown_encodings.size() < cache_->limits.max_unknown_encodings) {
                cache_->unknown_encodings.insert(encodings_[i]);
            }
        }
        want(types);
        next_types();
    }

    // A last step: asks the Variables of values whose encoding no node has for their DataType.

    void ask_variables(const binary::DynamicTypes& types)
    {
        std::vector<ReadValueId> items;
        for (std::size_t i = 0; i < std::min(values_.size(), variables_.size()); ++i) {
            const ExtensionObject* const object = detail::first_structure(values_[i]);
            if (object == nullptr || variables_[i].is_null() ||
                types.find_encoding(object->encoding_id()) != nullptr ||
                cache_->traced_encodings.size() >= cache_->limits.max_unknown_encodings ||
                !cache_->traced_encodings.insert(object->encoding_id()).second) {
                continue;
            }
            items.push_back(attribute_of(variables_[i], AttributeId::DataType));
            traced_.push_back({object, {}});
        }
        if (items.empty()) {
            return finish();
        }
        step_ =
            read(cache_->requester, std::move(items),
                 detail::step_of(shared_from_this(),
                                 [](LearnOperation& self, const std::vector<DataValue>& values) {
                                     self.take_variables(values);
                                 }),
                 {}, options_);
    }
    void take_variables(const std::vector<DataValue>& values)
    {
        if (!may_go_on()) {
            return;
        }
        std::vector<NodeId> types;
        for (std::size_t i = 0; i < traced_.size(); ++i) {
            if (const auto* const type = values[i].value.get_if<NodeId>()) {
                traced_[i].type = *type;
                types.push_back(*type);
            } else {
                cache_->traced_encodings.erase(traced_[i].value->encoding_id());
            }
        }
        want(types);
        next_types();
    }
    /// The types of the Variables are known by now, if they are described.
    void take_traced()
    {
        bool has_some = false;
        for (const Traced& each : std::exchange(traced_, {})) {
            const NodeId& encoding = each.value->encoding_id();
            if (cache_->compiled()->find_encoding(encoding) == nullptr && !each.type.is_null() &&
                cache_->take_encoding(each.type, *each.value)) {
                cache_->unknown_encodings.erase(encoding);
                has_some = true;
            }
        }
        // Others may be within, which could not be found before.
        if (!has_some) {
            finish();
        } else if (may_go_on()) {
            look_at_values();
        }
    }

    /// Does not request it again, unless an answer may be missing.
    void give_up(const NodeId& encoding)
    {
        if (!has_failed_ &&
            cache_->unknown_encodings.size() < cache_->limits.max_unknown_encodings) {
            cache_->unknown_encodings.insert(encoding);
        }
    }
    [[nodiscard]] BrowseLimits browse_limits() const
    {
        BrowseLimits limits;
        limits.max_references_per_node = 100; // a type has only a few
        return limits;
    }
    void finish()
    {
        if (const auto done = std::exchange(done_, nullptr)) {
            done();
        }
    }

    /// A structure, and the DataType of its Variable.
    struct Traced {
        const ExtensionObject* value;
        NodeId type;
    };

    std::shared_ptr<TypeCache::State> cache_;
    std::vector<Variant> values_;
    std::vector<NodeId> variables_;
    std::function<void()> done_;
    ServiceOptions options_;
    std::size_t steps_{0};
    std::uint64_t revision_{0};
    bool has_failed_{false};
    Operation step_;
    RequestId later_{0};
    bool is_later_{false};

    std::set<NodeId> wanted_;
    std::set<NodeId> seen_;
    std::set<NodeId> tried_encodings_;
    std::vector<NodeId> asked_;
    std::vector<DataValue> attributes_; // for asked_
    std::vector<NodeId> named_;         // types whose names are read
    std::set<NodeId> undescribed_;      // types to be searched in dictionaries
    std::vector<NodeId> encodings_;     // encodings whose types are requested
    std::vector<Traced> traced_;        // values whose Variables are asked
};

Operation begin(const std::shared_ptr<TypeCache::State>& state, const std::vector<NodeId>& types,
                std::vector<Variant> values, std::vector<NodeId> variables,
                std::function<void()> done, const ServiceOptions& options)
{
    const auto operation = std::make_shared<LearnOperation>(
        state, std::move(values), std::move(variables), std::move(done), options);
    operation->begin(types);
    return Operation{operation};
}

} // namespace

TypeCache::TypeCache(Requester& requester, TypeCacheLimits limits, DictionaryParser parser)
    : state_{std::make_shared<State>(requester, limits, parser)}
{
}
TypeCache::~TypeCache() = default;

std::shared_ptr<const binary::DynamicTypes> TypeCache::types() const
{
    state_->check_revision();
    return state_->compiled();
}

const std::vector<binary::DefinitionError>& TypeCache::dictionary_errors() const
{
    state_->check_revision();
    return state_->dictionary_errors;
}

Operation TypeCache::learn(const std::vector<NodeId>& data_types, std::function<void()> done,
                           const ServiceOptions& options)
{
    return begin(state_, data_types, {}, {}, std::move(done), options);
}

Operation TypeCache::learn_values(std::vector<Variant> values, std::function<void()> done,
                                  const ServiceOptions& options)
{
    return begin(state_, {}, std::move(values), {}, std::move(done), options);
}

Operation TypeCache::learn_values(std::vector<Variant> values, std::vector<NodeId> variables,
                                  std::function<void()> done, const ServiceOptions& options)
{
    return begin(state_, {}, std::move(values), std::move(variables), std::move(done), options);
}

} // namespace busbar::client
