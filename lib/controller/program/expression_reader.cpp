#include <array>
#include <utility>

#include <busbar/core/text.hpp>

#include "constant_table.hpp"
#include "core/ascii_case.hpp"
#include "declaration_keywords.hpp"
#include "expression.hpp"
#include "literal.hpp"

namespace busbar::controller::detail {

namespace {

using State = ExpressionValue::State;

struct OperatorRow {
    std::string_view word;
    Operator what;
    int rank;
};

/// IEC 61131-3, 3rd edition, table 71; a higher rank binds closer. Of two that begin alike the
/// longer one is first.
constexpr std::array operator_rows{
    OperatorRow{"OR", Operator::Or, 1},          OperatorRow{"OR_ELSE", Operator::Or, 1},
    OperatorRow{"XOR", Operator::Xor, 2},        OperatorRow{"AND", Operator::And, 3},
    OperatorRow{"AND_THEN", Operator::And, 3},   OperatorRow{"&", Operator::And, 3},
    OperatorRow{"<>", Operator::NotEqual, 4},    OperatorRow{"=", Operator::Equal, 4},
    OperatorRow{"<=", Operator::LessOrEqual, 5}, OperatorRow{">=", Operator::GreaterOrEqual, 5},
    OperatorRow{"<", Operator::Less, 5},         OperatorRow{">", Operator::Greater, 5},
    OperatorRow{"+", Operator::Add, 6},          OperatorRow{"-", Operator::Subtract, 6},
    OperatorRow{"MOD", Operator::Modulo, 7},     OperatorRow{"**", Operator::Power, 8},
    OperatorRow{"*", Operator::Multiply, 7},     OperatorRow{"/", Operator::Divide, 7},
};

bool is_symbol_of_operator(const DeclarationToken& token)
{
    return token.kind == DeclarationToken::Kind::Symbol && token.text.size() == 1 &&
           std::string_view{"&<>=+-*/"}.find(token.text.front()) != std::string_view::npos;
}

/// True if a word may be the name of a constant or of a value of an enumeration.
bool is_value_name(std::string_view word)
{
    const WordKind kind = kind_of_word(word);
    return kind == WordKind::Name || kind == WordKind::LaterType || kind == WordKind::UnknownType;
}

/// Reads one expression of a cursor.
class ExpressionReader {
public:
    explicit ExpressionReader(DeclarationCursor& cursor)
        : cursor_{&cursor}, constants_{&cursor.constants()}
    {
    }

    /// Reads operands and the operators between them whose rank is `rank` or higher.
    [[nodiscard]] bool read(ExpressionValue& value, int rank)
    {
        if (!read_operand(value)) {
            return false;
        }
        while (const OperatorRow* row = next_operator()) {
            if (row->rank < rank) {
                break;
            }
            const std::size_t offset = cursor_->now().offset;
            take_operator(*row);
            ExpressionValue right;
            if (!read_deeper([&] { return read(right, row->rank + 1); }) ||
                !combine(*row, value, right, offset)) {
                return false;
            }
        }
        return true;
    }

private:
    template <typename Read>
    bool read_deeper(Read read)
    {
        if (!constants_->enter()) {
            return cursor_->fail_with(cursor_->now().offset,
                                      "has more than " +
                                          std::to_string(constants_->limits().max_depth) +
                                          " expressions within one another");
        }
        const bool is_read = read();
        constants_->leave();
        return is_read;
    }

    [[nodiscard]] const OperatorRow* next_operator() const
    {
        const DeclarationToken& now = cursor_->now();
        if (now.kind == DeclarationToken::Kind::Word) {
            for (const OperatorRow& row : operator_rows) {
                if (cursor_->is_word(row.word)) {
                    return &row;
                }
            }
            return nullptr;
        }
        if (!is_symbol_of_operator(now)) {
            return nullptr;
        }
        for (const OperatorRow& row : operator_rows) {
            if (cursor_->rest().starts_with(row.word)) {
                return &row;
            }
        }
        return nullptr;
    }

    /// The lexer cuts symbols of one character.
    void take_operator(const OperatorRow& row)
    {
        const bool is_word = cursor_->now().kind == DeclarationToken::Kind::Word;
        const std::size_t tokens = is_word ? 1 : row.word.size();
        for (std::size_t i = 0; i < tokens; ++i) {
            cursor_->take();
        }
    }

    [[nodiscard]] bool take_steps(const ExpressionValue& value)
    {
        constexpr std::size_t bytes_of_step = 64;
        const auto* text = value.value.get_if<String>();
        return constants_->take_steps(1 + (text == nullptr ? 0 : text->size() / bytes_of_step)) ||
               cursor_->fail_with(value.offset,
                                  "takes, with the expressions before it, more than " +
                                      std::to_string(constants_->limits().max_steps) + " steps");
    }

    [[nodiscard]] bool accept(ExpressionResult result, ExpressionValue& value, std::size_t begin,
                              std::size_t offset, std::string_view what)
    {
        if (!result) {
            return cursor_->fail_with(offset, "the operation '" + std::string{what} + "' " +
                                                  result.error());
        }
        value = std::move(*result);
        value.offset = begin;
        return take_steps(value);
    }

    [[nodiscard]] bool combine(const OperatorRow& row, ExpressionValue& value,
                               const ExpressionValue& right, std::size_t offset)
    {
        if (!require_value(*cursor_, value) || !require_value(*cursor_, right)) {
            return false;
        }
        const std::size_t begin = value.offset;
        if (value.is_later() || right.is_later()) {
            return become_later(value, begin);
        }
        return accept(apply_operator(row.what, value, right), value, begin, offset, row.word);
    }

    static bool become_later(ExpressionValue& value, std::size_t begin)
    {
        value = {};
        value.state = State::Later;
        value.offset = begin;
        return true;
    }

    [[nodiscard]] bool read_operand(ExpressionValue& value)
    {
        value.offset = cursor_->now().offset;
        if (cursor_->is_symbol("-") || cursor_->is_symbol("+")) {
            return read_signed(value);
        }
        if (cursor_->is_word("NOT")) {
            return read_not(value);
        }
        if (cursor_->skip_symbol("(")) {
            const std::size_t begin = value.offset;
            const bool is_read = read_deeper([&] { return read(value, 0); }) &&
                                 require_value(*cursor_, value) && cursor_->expect_symbol(")");
            value.offset = begin;
            return is_read;
        }
        switch (cursor_->now().kind) {
        case DeclarationToken::Kind::Number: {
            const DeclarationToken token = cursor_->take();
            return set_literal(token, read_number_literal(token.text, false), value);
        }
        case DeclarationToken::Kind::Text: {
            const DeclarationToken token = cursor_->take();
            return set_literal(token, read_text_literal(token.text), value);
        }
        case DeclarationToken::Kind::Typed:
            return read_typed(value);
        case DeclarationToken::Kind::Word:
            return read_word(value);
        default:
            return cursor_->fail("a value");
        }
    }

    [[nodiscard]] bool read_signed(ExpressionValue& value)
    {
        const DeclarationToken sign = cursor_->take();
        const bool is_negative = sign.text == "-";
        const DeclarationToken next = cursor_->now();
        if (next.kind == DeclarationToken::Kind::Number) {
            // The most negative number has no positive one.
            cursor_->take();
            const bool is_set =
                set_literal(next, read_number_literal(next.text, is_negative), value);
            value.offset = sign.offset;
            return is_set;
        }
        if (!read_deeper([&] { return read_operand(value); }) || !require_value(*cursor_, value)) {
            return false;
        }
        return value.is_later() || !is_negative
                   ? !is_negative || become_later(value, sign.offset)
                   : accept(apply_minus(value), value, sign.offset, sign.offset, sign.text);
    }

    [[nodiscard]] bool read_not(ExpressionValue& value)
    {
        const DeclarationToken word = cursor_->take();
        if (!read_deeper([&] { return read_operand(value); }) || !require_value(*cursor_, value)) {
            return false;
        }
        return value.is_later() ? become_later(value, word.offset)
                                : accept(apply_not(value), value, word.offset, word.offset, "NOT");
    }

    [[nodiscard]] bool set_literal(const DeclarationToken& token, LiteralResult literal,
                                   ExpressionValue& value)
    {
        if (!literal) {
            return cursor_->fail_with(token.offset, std::move(literal).error());
        }
        value.value = std::move(literal->value);
        value.notation = literal->notation;
        return take_steps(value);
    }

    [[nodiscard]] bool read_typed(ExpressionValue& value)
    {
        const DeclarationToken token = cursor_->take();
        const std::size_t hash = token.text.find('#');
        const std::string_view prefix = token.text.substr(0, hash);
        if (auto literal = read_typed_literal(token.text)) {
            value.type = elementary_type(prefix);
            return set_literal(token, std::move(*literal), value);
        }
        const std::string_view name = token.text.substr(hash + 1);
        const bool is_one_word = !name.empty() && (name.front() < '0' || name.front() > '9') &&
                                 name.find_first_of("#.:+-\"'") == std::string_view::npos;
        if (!is_one_word || !is_value_name(prefix) || !is_value_name(name)) {
            return cursor_->fail_at(token, "the name of a type, '#' and a value of it");
        }
        return read_name({prefix, name}, value);
    }

    [[nodiscard]] bool read_word(ExpressionValue& value)
    {
        const bool is_true = cursor_->is_word("TRUE");
        if (is_true || cursor_->is_word("FALSE")) {
            cursor_->take();
            value.value = Variant{is_true};
            value.type = ElementaryType::Bool;
            return take_steps(value);
        }
        if (!is_value_name(cursor_->now().text)) {
            return cursor_->fail("a value");
        }
        const DeclarationToken first = cursor_->take();
        if (cursor_->is_symbol("(") && is_function(first.text)) {
            return read_call(first, value);
        }
        std::vector<std::string_view> parts{first.text};
        while (cursor_->skip_symbol(".")) {
            if (cursor_->now().kind != DeclarationToken::Kind::Word ||
                !is_value_name(cursor_->now().text)) {
                return cursor_->fail("the name of a value");
            }
            parts.push_back(cursor_->take().text);
        }
        // What is between the parentheses may be repeated: [N(0)].
        return read_name(parts, value) &&
               (!cursor_->is_symbol("(") || value.state <= State::Later ||
                cursor_->fail_at(first, "a value, or a function that is computed here"));
    }

    [[nodiscard]] bool read_name(const std::vector<std::string_view>& parts, ExpressionValue& value)
    {
        value.name = parts.back();
        value.enumeration = parts.size() > 1 ? parts[parts.size() - 2] : std::string_view{};
        return constants_->find(*cursor_, parts, value.offset, value) && take_steps(value);
    }

    [[nodiscard]] bool read_call(const DeclarationToken& word, ExpressionValue& value)
    {
        cursor_->take();
        if (busbar::detail::is_same_ignoring_case(word.text, "SIZEOF")) {
            return read_size(value);
        }
        std::vector<ExpressionValue> arguments;
        bool is_later = false;
        do {
            ExpressionValue& argument = arguments.emplace_back();
            if (!read_deeper([&] { return read(argument, 0); }) ||
                !require_value(*cursor_, argument)) {
                return false;
            }
            is_later = is_later || argument.is_later();
        } while (cursor_->skip_symbol(","));
        if (!cursor_->skip_symbol(")")) {
            return cursor_->fail("',' or ')'");
        }
        return is_later
                   ? become_later(value, word.offset)
                   : accept(apply_function(word.text, arguments, constants_->limits().max_text),
                            value, word.offset, word.offset, word.text);
    }

    [[nodiscard]] bool read_size(ExpressionValue& value)
    {
        const DeclarationToken first = cursor_->now();
        if (first.kind != DeclarationToken::Kind::Word) {
            return cursor_->fail("the name of a type");
        }
        std::string type{cursor_->take().text};
        while (cursor_->skip_symbol(".")) {
            type = cursor_->take().text;
        }
        std::uint64_t size = 0;
        value.state = constants_->size_of(type, size);
        if (value.state == State::Missing) {
            return cursor_->fail_at(first, "the name of a type whose size is known");
        }
        value.value = Variant{static_cast<std::int64_t>(size)};
        return cursor_->expect_symbol(")") && take_steps(value);
    }

    DeclarationCursor* cursor_;
    ConstantTable* constants_;
};

} // namespace

bool read_expression(DeclarationCursor& cursor, ExpressionValue& value)
{
    return ExpressionReader{cursor}.read(value, 0);
}

bool require_value(DeclarationCursor& cursor, const ExpressionValue& value)
{
    constexpr std::size_t enough = 60;
    const std::string qualifier = value.enumeration.empty() ? "" : value.enumeration + ".";
    const std::string name = printable(qualifier + value.name, enough);
    if (value.state == State::Missing) {
        return cursor.fail_with(value.offset,
                                "found '" + name +
                                    "', which is neither a constant nor a value of an enumeration "
                                    "that is declared here");
    }
    return value.state != State::Ambiguous ||
           cursor.fail_with(value.offset, "found '" + name +
                                              "', which several enumerations have, expected the "
                                              "name of one and a point before it");
}

} // namespace busbar::controller::detail
