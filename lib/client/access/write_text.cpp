#include <busbar/client/attributes.hpp>

#include "binary/dynamic/data_type_root.hpp"
#include "text_operation.hpp"

namespace busbar::client {

namespace {

/// Resolves, reads the Variable's type, learns it, reads the text, writes.
class WriteText final : public detail::TextOperation<void>,
                        public std::enable_shared_from_this<WriteText> {
public:
    WriteText(Requester& requester, TypeCache& types, std::string text, Done done,
              const ServiceOptions& options)
        : TextOperation{requester, types, std::move(done), options}, text_{std::move(text)}
    {
    }

    void begin(const NodeAddress& node)
    {
        step_ =
            resolve(requester_, {node},
                    detail::step_of(shared_from_this(),
                                    [](WriteText& self, const std::vector<Result<NodeId>>& ids) {
                                        self.resolved(ids.front());
                                    }),
                    options_);
    }

private:
    void resolved(const Result<NodeId>& id)
    {
        if (!id) {
            return fail_with(id.error(), "the address names no node");
        }
        node_ = *id;
        step_ = read(requester_,
                     {attribute_of(node_, AttributeId::DataType),
                      attribute_of(node_, AttributeId::ValueRank)},
                     detail::step_of(shared_from_this(),
                                     [](WriteText& self, const std::vector<DataValue>& values) {
                                         self.learn(values[0], values[1]);
                                     }),
                     {}, options_);
    }
    void learn(const DataValue& data_type, const DataValue& value_rank)
    {
        const NodeId* const type = data_type.value.get_if<NodeId>();
        if (type == nullptr) {
            return fail_with(data_type.status.is_bad() ? data_type.status
                                                       : status::Bad_UnknownResponse,
                             "its DataType cannot be read");
        }
        data_type_ = *type;
        value_rank_ = value_rank.value.value_or<std::int32_t>(-2);
        step_ = types_.learn(
            {data_type_},
            detail::step_of(shared_from_this(), [](WriteText& self) { self.write_value(); }),
            options_);
    }
    void write_value()
    {
        const auto types = types_.types();
        const auto type = value_type_of(data_type_, value_rank_, *types);
        if (!type) {
            return fail_with(type.error(), "its DataType " + printable(to_string(data_type_)) +
                                               " is not described by the server");
        }
        auto value = parse_value(text_, *type);
        if (!value) {
            return fail_with(status::Bad_TypeMismatch, "value: " + value.error().message);
        }
        step_ = write(requester_, {value_for(node_, DataValue{*std::move(value)})},
                      detail::step_of(shared_from_this(),
                                      [](WriteText& self, const std::vector<StatusCode>& results) {
                                          self.written(results.front());
                                      }),
                      options_);
    }
    void written(StatusCode status)
    {
        status.is_bad() ? fail_with(status, "the value was not written") : end({});
    }

    std::string text_;
    NodeId node_;
    NodeId data_type_;
    std::int32_t value_rank_{-2};
};

} // namespace

Result<ValueType> value_type_of(const NodeId& data_type, std::int32_t value_rank,
                                const binary::DynamicTypes& types)
{
    ValueType type;
    type.value_rank = value_rank;
    type.types = &types;
    if (const auto* const known = types.find(data_type)) {
        type.built_in = known->built_in;
        type.type = known;
        return type;
    }
    const auto root = binary::detail::data_type_root(data_type);
    if (!root) {
        return fail(status::Bad_DataTypeIdUnknown);
    }
    type.built_in = root->built_in;
    return type;
}

Operation write_text(Requester& requester, TypeCache& types, const NodeAddress& node,
                     std::string text, std::function<void(Accessed<void>)> done,
                     const ServiceOptions& options)
{
    const auto operation =
        std::make_shared<WriteText>(requester, types, std::move(text), std::move(done), options);
    operation->begin(node);
    return Operation{operation};
}

} // namespace busbar::client
