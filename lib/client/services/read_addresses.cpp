#include <busbar/client/attributes.hpp>

namespace busbar::client {

namespace {

/// Resolves the addresses, then reads those that could be resolved.
class ReadAddresses final : public detail::OperationState,
                            public std::enable_shared_from_this<ReadAddresses> {
public:
    using Done = std::function<void(std::vector<DataValue>)>;

    ReadAddresses(Requester& requester, Done done, AttributeId attribute, ReadSettings settings,
                  const ServiceOptions& options)
        : requester_{requester}, done_{std::move(done)},
          attribute_{attribute}, settings_{settings}, options_{options}
    {
    }

    void begin(std::vector<NodeAddress> nodes)
    {
        step_ = resolve(
            requester_, std::move(nodes),
            [self = shared_from_this()](const std::vector<Result<NodeId>>& ids) {
                self->resolved(ids);
            },
            options_);
    }
    void cancel() override
    {
        done_ = nullptr;
        step_.cancel();
    }

private:
    void resolved(const std::vector<Result<NodeId>>& ids)
    {
        std::vector<ReadValueId> items;
        values_.resize(ids.size());
        for (std::size_t i = 0; i < ids.size(); ++i) {
            if (ids[i]) {
                items.push_back(attribute_of(*ids[i], attribute_));
                asked_.push_back(i);
            } else {
                values_[i].status = ids[i].error();
            }
        }
        if (items.empty()) {
            return finish();
        }
        step_ = read(
            requester_, std::move(items),
            [self = shared_from_this()](std::vector<DataValue> values) {
                for (std::size_t i = 0; i < values.size(); ++i) {
                    self->values_[self->asked_[i]] = std::move(values[i]);
                }
                self->finish();
            },
            settings_, options_);
    }
    void finish()
    {
        if (const Done done = std::exchange(done_, nullptr)) {
            done(std::move(values_));
        }
    }

    Requester& requester_;
    Done done_;
    AttributeId attribute_;
    ReadSettings settings_;
    ServiceOptions options_;
    Operation step_;
    std::vector<DataValue> values_;
    std::vector<std::size_t> asked_;
};

} // namespace

Operation read(Requester& requester, std::vector<NodeAddress> nodes,
               std::function<void(std::vector<DataValue>)> done, AttributeId attribute,
               ReadSettings settings, const ServiceOptions& options)
{
    const auto operation =
        std::make_shared<ReadAddresses>(requester, std::move(done), attribute, settings, options);
    operation->begin(std::move(nodes));
    return Operation{operation};
}

} // namespace busbar::client
