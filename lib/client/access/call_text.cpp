#include <algorithm>

#include <busbar/client/attributes.hpp>
#include <busbar/client/methods.hpp>
#include <busbar/client/view.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "text_operation.hpp"

namespace busbar::client {

namespace {

/// Resolves, finds and reads InputArguments, learns their types, reads the texts, calls.
class CallText final : public detail::TextOperation<CallMethodResult>,
                       public std::enable_shared_from_this<CallText> {
public:
    CallText(Requester& requester, TypeCache& types, std::vector<std::string> texts, Done done,
             const ServiceOptions& options)
        : TextOperation{requester, types, std::move(done), options}, texts_{std::move(texts)}
    {
    }

    void begin(const NodeAddress& object, const NodeAddress& method)
    {
        step_ = resolve(requester_, {object, method},
                        detail::step_of(shared_from_this(),
                                        [](CallText& self, const std::vector<Result<NodeId>>& ids) {
                                            self.resolved(ids[0], ids[1]);
                                        }),
                        options_);
    }

private:
    void resolved(const Result<NodeId>& object, const Result<NodeId>& method)
    {
        if (!object || !method) {
            return fail_with(object ? method.error() : object.error(),
                             object ? "the method's address names no node"
                                    : "the object's address names no node");
        }
        request_.object_id = *object;
        request_.method_id = *method;
        BrowseDescription properties = children_of(*method);
        properties.reference_type_id = NodeId{0, id::HasProperty};
        step_ =
            browse(requester_, {std::move(properties)},
                   detail::step_of(shared_from_this(),
                                   [](CallText& self, const std::vector<BrowseResult>& results) {
                                       self.found_properties(results.front());
                                   }),
                   {}, options_);
    }
    void found_properties(const BrowseResult& properties)
    {
        if (properties.status_code.is_bad()) {
            return fail_with(properties.status_code, "the method cannot be browsed");
        }
        for (const ReferenceDescription& property : properties.references) {
            if (property.browse_name == QualifiedName{0, "InputArguments"} &&
                property.node_id.is_local()) {
                return read_arguments(property.node_id.node_id);
            }
        }
        learn(); // a method without arguments has no such property (Part 3, 5.7)
    }
    void read_arguments(const NodeId& property)
    {
        step_ = read(requester_, {attribute_of(property)},
                     detail::step_of(shared_from_this(),
                                     [](CallText& self, const std::vector<DataValue>& values) {
                                         self.take_arguments(values.front());
                                     }),
                     {}, options_);
    }
    void take_arguments(const DataValue& value)
    {
        const auto* const objects = value.value.array_if<ExtensionObject>();
        if (objects == nullptr) {
            return fail_with(value.status.is_bad() ? value.status : status::Bad_UnknownResponse,
                             "the method's InputArguments cannot be read");
        }
        for (const ExtensionObject& object : *objects) {
            const auto* const argument = object.get_if<Argument>();
            arguments_.push_back(argument != nullptr ? *argument : Argument{});
        }
        learn();
    }
    void learn()
    {
        if (arguments_.size() != texts_.size()) {
            return fail_with(arguments_.size() > texts_.size() ? status::Bad_ArgumentsMissing
                                                               : status::Bad_TooManyArguments,
                             "the method has " + std::to_string(arguments_.size()) +
                                 " arguments, not " + std::to_string(texts_.size()));
        }
        std::vector<NodeId> types;
        for (const Argument& argument : arguments_) {
            types.push_back(argument.data_type);
        }
        step_ = types_.learn(
            std::move(types),
            detail::step_of(shared_from_this(), [](CallText& self) { self.call_method(); }),
            options_);
    }
    void call_method()
    {
        const auto types = types_.types();
        for (std::size_t i = 0; i < texts_.size(); ++i) {
            const Argument& argument = arguments_[i];
            const auto type = value_type_of(argument.data_type, argument.value_rank, *types);
            if (!type) {
                return fail_with(type.error(), name_of(i) + ": its DataType " +
                                                   printable(to_string(argument.data_type)) +
                                                   " is not described by the server");
            }
            auto value = parse_value(texts_[i], *type);
            if (!value) {
                return fail_with(status::Bad_InvalidArgument,
                                 name_of(i) + ": " + value.error().message);
            }
            request_.input_arguments.push_back(*std::move(value));
        }
        step_ = call(requester_, {std::move(request_)},
                     detail::step_of(shared_from_this(),
                                     [](CallText& self, std::vector<CallMethodResult> results) {
                                         self.called(std::move(results.front()));
                                     }),
                     options_);
    }
    void called(CallMethodResult result)
    {
        if (!result.status_code.is_bad()) {
            return end(std::move(result));
        }
        std::string message = "the call failed";
        const std::size_t count = std::min(result.input_argument_results.size(), texts_.size());
        for (std::size_t i = 0; i < count; ++i) {
            const StatusCode status = result.input_argument_results[i];
            if (status.is_bad()) {
                message += "; " + name_of(i) + ": " + std::string{name(status)};
            }
        }
        fail_with(result.status_code, std::move(message));
    }
    [[nodiscard]] std::string name_of(std::size_t argument) const
    {
        const std::string_view known = arguments_[argument].name.view();
        return known.empty() ? "argument " + std::to_string(argument + 1) : printable(known, 64);
    }

    std::vector<std::string> texts_;
    std::vector<Argument> arguments_;
    CallMethodRequest request_;
};

} // namespace

Operation call_text(Requester& requester, TypeCache& types, const NodeAddress& object,
                    const NodeAddress& method, std::vector<std::string> arguments,
                    std::function<void(Accessed<CallMethodResult>)> done,
                    const ServiceOptions& options)
{
    const auto operation = std::make_shared<CallText>(requester, types, std::move(arguments),
                                                      std::move(done), options);
    operation->begin(object, method);
    return Operation{operation};
}

} // namespace busbar::client
