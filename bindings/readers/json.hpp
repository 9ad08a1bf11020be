// JSON (RFC 8259): values in memory, read from a text and written to one.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace readers {

class Json {
public:
    using Array = std::vector<Json>;
    using Member = std::pair<std::string, Json>;

    Json() = default; // null
    Json(bool b) : value_(b) {}
    Json(double x) : value_(x) {}
    Json(std::string text) : value_(std::move(text)) {}
    Json(const char* text) : value_(std::string(text)) {}
    Json(Array array) : value_(std::move(array)) {}
    Json(std::initializer_list<Member> members) : value_(Object{members, false}) {}
    template <class T, std::enable_if_t<std::is_integral_v<T> && !std::is_same_v<T, bool>, int> = 0>
    Json(T n) : value_(n < T(0) ? Value(static_cast<int64_t>(n)) : Value(static_cast<uint64_t>(n))) {}
    template <class T>
    Json(const std::vector<T>& list) : value_(Array(list.begin(), list.end())) {}

    bool is_null() const { return value_.index() == 0; }
    bool is_array() const { return std::holds_alternative<Array>(value_); }
    bool is_object() const { return std::holds_alternative<Object>(value_); }
    bool is_true() const {
        const bool* const b = std::get_if<bool>(&value_);
        return b && *b;
    }
    const std::string* text() const { return std::get_if<std::string>(&value_); } // NULL: something else
    const uint64_t* whole() const { return std::get_if<uint64_t>(&value_); } // written without point, exponent, sign
    bool is_number() const { return value_.index() >= 2 && value_.index() <= 4; }
    double number() const; // of a number, else 0

    // The elements of an array; of anything else there are none.
    const Array& elements() const;
    // The members of an object; of anything else there are none.
    const std::vector<Member>& members() const;
    // A member of an object, or NULL.  Of several with one name the last; takes the logarithm of their number.
    const Json* find(std::string_view name) const;
    // Adds a member, or gives it another value; null becomes an object.
    void set(const std::string& name, Json value);

    // indent 0: all in one line.  What is not UTF-8 is replaced by U+FFFD, what is no number by null.
    std::string dump(int indent = 0) const;

private:
    struct Object {
        std::vector<Member> members;
        bool sorted; // by name
    };
    using Value = std::variant<std::nullptr_t, bool, uint64_t, int64_t, double, std::string, Array, Object>;
    friend class JsonParser;
    void append_to(std::string& text, int indent, int depth) const;

    Value value_;
};

struct JsonError : std::runtime_error {
    size_t byte; // from 0
    JsonError(const char* sentence, size_t at) : std::runtime_error(sentence), byte(at) {}
};

// Not more than 64 arrays and objects in each other.  Throws JsonError.
Json parse_json(std::string_view text);

} // namespace readers
