#include "live_writer.hpp"

#include <busbar/client/attributes.hpp>

#include "tool/printing/display_text.hpp"
#include "tool/printing/value.hpp"

namespace busbar::tool::watch {

namespace {

/// Part 3, 8.57
constexpr std::uint8_t current_write = 2;

/// Fails at once if the connection is lost, to keep the view responsive.
client::ServiceOptions at_once()
{
    client::RequestOptions options;
    options.waits_for_session = false;
    return options;
}

} // namespace

void LiveWriter::later(std::function<void()> work)
{
    stream_->push([this, round = round_, work = std::move(work)] {
        if (round == round_) {
            work();
        }
    });
}

void LiveWriter::prepare(const client::NodeAddress& node, Prepared done)
{
    ++round_;
    prepared_ = std::move(done);
    client::resolve(
        connection_->client(), {node},
        [this, round = round_](std::vector<Result<NodeId>> ids) {
            if (round != round_) {
                return;
            }
            if (ids.front()) {
                ask(*ids.front());
            } else {
                later([this, why = ids.front().error()] { prepared_("", text_of(why)); });
            }
        },
        at_once());
}

void LiveWriter::ask(const NodeId& node)
{
    node_ = node;
    std::vector<ReadValueId> items;
    for (const AttributeId attribute :
         {AttributeId::DataType, AttributeId::ValueRank, AttributeId::UserAccessLevel}) {
        items.push_back(client::attribute_of(node, attribute));
    }
    client::read(
        connection_->client(), std::move(items),
        [this, round = round_](std::vector<DataValue> attributes) {
            if (round == round_) {
                take(std::move(attributes));
            }
        },
        client::ReadSettings{}, at_once());
}

void LiveWriter::take(std::vector<DataValue> attributes)
{
    const StatusCode status = attributes[0].status;
    if (status.is_bad()) {
        later([this, status] { prepared_("", text_of(status)); });
        return;
    }
    // If the server does not tell, the attempt decides.
    if ((attributes[2].value.value_or<std::uint8_t>(current_write) & current_write) == 0) {
        later([this] { prepared_("", "read only, for this user"); });
        return;
    }
    data_type_ = attributes[0].value.value_or<NodeId>({});
    value_rank_ = attributes[1].value.value_or<std::int32_t>(-2);
    connection_->types().learn(
        {data_type_},
        [this, round = round_] {
            if (round == round_) {
                later([this] { ready(); });
            }
        },
        at_once());
}

void LiveWriter::ready()
{
    const TypeOfValue type = value_type(connection_->types().types(), data_type_, value_rank_);
    std::string text{type.type != nullptr ? type.type->name : std::string{name(type.built_in)}};
    prepared_(safe(text) + (value_rank_ >= 0 ? "[]" : ""), "");
}

void LiveWriter::write(const std::string& text, std::function<void(const Outcome&)> done)
{
    DataValue value;
    try {
        const TypeOfValue type = value_type(connection_->types().types(), data_type_, value_rank_);
        value.value = parse_value(text, type, "not written");
    } catch (const Failure& failure) {
        done({status::Bad_TypeMismatch, failure.what()});
        return;
    }
    client::write(
        connection_->client(), {client::value_for(node_, std::move(value))},
        [this, done = std::move(done)](std::vector<StatusCode> statuses) {
            stream_->push([status = statuses.front(), done] { done({status, ""}); });
        },
        at_once());
}

} // namespace busbar::tool::watch
