package paros;

import java.util.ArrayDeque;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.HashMap;
import java.util.List;
import java.util.Map;

/** What the stub classes answer, and what they were asked. */
public final class Fake {
    private static final Map<String, ArrayDeque<Object>> answers = new HashMap<>();
    /** Stands for null, which no queue takes. */
    private static final Object NULL = new Object();
    private static final List<String> calls = new ArrayList<>();

    /**
     * Answers a member, or a member with these arguments in brackets, by `KIND:VALUE` from now on; by
     * one line after the other, where there are several, and by the last for good.
     */
    public static void set(String member, String answer) throws Exception {
        ArrayDeque<Object> all = new ArrayDeque<>();
        for (String line : answer.split("\n")) {
            all.add(value(line));
        }
        answers.put(member, all);
    }

    private static Object value(String answer) throws Exception {
        String value = answer.substring(2);
        return switch (answer.charAt(0)) {
            case 'I' -> (Object) Integer.valueOf(value);
            case 'F' -> Float.valueOf(value);
            case 'Z' -> Boolean.valueOf(value);
            case 'S' -> value;
            case 'O' -> Class.forName(value).getDeclaredConstructor().newInstance();
            // The keys in these places, parted by commas.
            case 'K' -> new java.util.TreeSet<>(Arrays.asList(value.split(",")));
            case 'P' -> new java.io.File(value);
            case 'E' -> new SecurityException(value);
            default -> NULL;
        };
    }

    /** Sets a field, `CLASS.NAME`, by `KIND:VALUE`. */
    public static void field(String field, String answer) throws Exception {
        Object value = value(answer);
        int dot = field.lastIndexOf('.');
        Class.forName(field.substring(0, dot)).getField(field.substring(dot + 1)).set(null, value == NULL ? null : value);
    }

    /** The calls since it was last asked, a line each. */
    public static String calls() {
        String all = String.join("\n", calls);
        calls.clear();
        return all;
    }

    /** A stub's body. */
    public static Object answer(String member, Object... arguments) {
        String call = member + Arrays.stream(arguments).map(Fake::text).toList();
        calls.add(call);
        ArrayDeque<Object> all = answers.containsKey(call) ? answers.get(call) : answers.get(member);
        Object answer = all == null ? NULL : all.size() > 1 ? all.poll() : all.peek();
        if (answer instanceof RuntimeException) {
            throw (RuntimeException) answer;
        }
        return answer == NULL ? null : answer;
    }

    private static String text(Object argument) {
        if (argument instanceof Object[]) {
            return Arrays.toString((Object[]) argument);
        }
        boolean plain = argument == null || argument.getClass().getName().startsWith("java.lang.");
        return plain ? String.valueOf(argument) : argument.getClass().getSimpleName();
    }
}
