package paros;

import java.util.ArrayList;
import java.util.Arrays;
import java.util.HashMap;
import java.util.List;
import java.util.Map;

/** What the stub classes answer, and what they were asked. */
public final class Fake {
    private static final Map<String, Object> answers = new HashMap<>();
    private static final List<String> calls = new ArrayList<>();

    /** Answers a member, or a member with these arguments in brackets, by `KIND:VALUE` from now on. */
    public static void set(String member, String answer) throws Exception {
        String value = answer.substring(2);
        answers.put(member, switch (answer.charAt(0)) {
            case 'I' -> (Object) Integer.valueOf(value);
            case 'F' -> Float.valueOf(value);
            case 'Z' -> Boolean.valueOf(value);
            case 'S' -> value;
            case 'O' -> Class.forName(value).getDeclaredConstructor().newInstance();
            case 'P' -> new java.io.File(value);
            case 'E' -> new SecurityException(value);
            default -> null;
        });
    }

    /** Sets a field, `CLASS.NAME`, by `KIND:VALUE`. */
    public static void field(String field, String answer) throws Exception {
        set("field", answer);
        int dot = field.lastIndexOf('.');
        Class.forName(field.substring(0, dot)).getField(field.substring(dot + 1)).set(null, answers.get("field"));
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
        Object answer = answers.containsKey(call) ? answers.get(call) : answers.get(member);
        if (answer instanceof RuntimeException) {
            throw (RuntimeException) answer;
        }
        return answer;
    }

    private static String text(Object argument) {
        if (argument instanceof Object[]) {
            return Arrays.toString((Object[]) argument);
        }
        boolean plain = argument == null || argument.getClass().getName().startsWith("java.lang.");
        return plain ? String.valueOf(argument) : argument.getClass().getSimpleName();
    }
}
